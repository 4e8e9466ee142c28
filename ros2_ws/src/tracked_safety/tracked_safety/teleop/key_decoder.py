"""From what a terminal sends to keys."""

_ARROWS = {b"A": "up", b"B": "down", b"C": "right", b"D": "left"}
_ESCAPE = 0x1B
_MOST_BYTES = 4096  # somebody pastes a book: only the end of it matters


class KeyDecoder:
    """Bytes in, keys out: printable letters as they are, arrows by direction, everything else as ``unknown``."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> list[str]:
        """Keys that are complete; without new data, an escape sequence that has not been completed is none."""
        waited, self._rest = self._rest, b""
        if waited and not data:
            return ["unknown"]
        data = (waited + data)[-_MOST_BYTES:]
        keys = []
        while data:
            if data[0] != _ESCAPE:
                keys.append(chr(data[0]).lower() if 0x20 <= data[0] < 0x7F else "unknown")
                data = data[1:]
            elif len(data) < 3 and data[1:] in (b"", b"[", b"O"):
                self._rest, data = data, b""
            elif data[1:2] in (b"[", b"O"):
                keys.append(_ARROWS.get(data[2:3], "unknown"))
                data = data[3:]
            else:
                keys.append("unknown")
                data = data[1:]
        return keys
