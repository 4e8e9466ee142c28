import io

from tracked_bringup.console import Console


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_line_that_stays_is_written_above_the_live_line() -> None:
    stream = Terminal()
    console = Console(stream)
    console.status("1 s")
    console.say("hello")
    console.status("")
    assert stream.getvalue() == "1 s\r\x1b[Khello\n1 s\r\x1b[K"


def test_without_a_terminal_there_is_no_live_line() -> None:
    stream = io.StringIO()
    console = Console(stream)
    console.status("1 s")
    console.say("hello", "red")
    assert stream.getvalue() == "hello\n"
