"""MCAP files that end too early, since their recorder was killed: found, and made whole again."""

import os
import shutil
from pathlib import Path
from typing import BinaryIO

from tracked_bringup.bags.bag_error import BagError, one_line

_MAGIC = b"\x89MCAP0\r\n"
_FOOTER, _CHUNK, _DATA_END = 0x02, 0x06, 0x0F
_HEAD = 9  # one byte of kind, eight of length
_TAIL = bytes([_DATA_END, 4, *[0] * 7, *[0] * 4, _FOOTER, 20, *[0] * 7, *[0] * 20]) + _MAGIC
"""End of the data and a footer that promises no index, which the format allows."""


def is_cut(path: Path) -> bool:
    """Whether an MCAP file lacks its end.

    Raises
    ------
    BagError: the file cannot be read, or is none.
    """
    try:
        with path.open("rb") as file:
            _check_magic(file, path)
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - len(_MAGIC)))
            return size < 2 * len(_MAGIC) or file.read() != _MAGIC
    except OSError as error:
        raise _unreadable(path, error) from error


def mend(path: Path, mended: Path) -> int:
    """Copy what is whole of a cut file and give it an end, so that every tool can read it; the number of whole chunks.

    Raises
    ------
    BagError: the file is no MCAP file or has no whole chunk, or the copy cannot be written.
    """
    try:
        with path.open("rb") as file:
            _check_magic(file, path)
            end, chunks = _whole(file)
            if not chunks:
                raise BagError(f"{path} has no whole chunk: nothing in it can be saved")
            partial = mended.with_suffix(".partial")
            with partial.open("wb") as copy:
                file.seek(0)
                _copy(file, copy, end)
                copy.write(_TAIL)
            partial.replace(mended)
            return chunks
    except BagError:
        raise
    except OSError as error:
        raise BagError(f"{path} cannot be mended as {mended} ({one_line(error)})") from error


def _whole(file: BinaryIO) -> tuple[int, int]:
    """End of the last record that is all there, and the number of chunks before it."""
    size, place, chunks = file.seek(0, os.SEEK_END), len(_MAGIC), 0
    while place + _HEAD <= size:
        file.seek(place)
        head = file.read(_HEAD)
        after = place + _HEAD + int.from_bytes(head[1:], "little")
        if head[0] in (0, _DATA_END, _FOOTER) or after > size:
            break
        chunks += head[0] == _CHUNK
        place = after
    return place, chunks


def _copy(source: BinaryIO, target: BinaryIO, count: int) -> None:
    shutil.copyfileobj(source, target)
    target.truncate(count)
    target.seek(count)


def _check_magic(file: BinaryIO, path: Path) -> None:
    if file.read(len(_MAGIC)) != _MAGIC:
        raise BagError(f"{path} is no MCAP file")


def _unreadable(path: Path, error: OSError) -> BagError:
    return error if isinstance(error, BagError) else BagError(f"{path} cannot be read ({one_line(error)})")
