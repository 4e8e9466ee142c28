"""What can be wrong with a recording."""


class BagError(OSError):
    """A recording cannot be written or read; the text names it and says why, in one sentence."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


def one_line(error: BaseException) -> str:
    """What an exception says, without line breaks and full stop; its kind where it says nothing."""
    said = getattr(error, "strerror", None) or str(error)
    return " ".join(str(said).split()).rstrip(".") or type(error).__name__
