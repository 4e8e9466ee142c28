"""Stamps: proof that a step succeeded, and on which inputs."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path


def fingerprint(texts: Iterable[str], files: Iterable[Path] = ()) -> str:
    """SHA-256 over strings and over the names and contents of files, in the order given."""
    digest = hashlib.sha256()
    for text in texts:
        digest.update(text.encode() + b"\0")
    for file in files:
        digest.update(file.name.encode() + b"\0" + hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()


class Stamp:
    """A file inside the product it vouches for, so that deleting the product deletes the proof.

    It is withdrawn before the product is touched and written after success, so that what an interruption leaves is
    never trusted.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def read(self) -> str:
        """The recorded fingerprint, or the empty string where there is none."""
        try:
            return self.path.read_text().strip()
        except OSError:
            return ""

    def withdraw(self) -> None:
        """Take the proof away."""
        self.path.unlink(missing_ok=True)

    def write(self, value: str) -> None:
        """Vouch for the product."""
        # Written beside and moved: a full disk must not leave half a proof.
        self.path.parent.mkdir(parents=True, exist_ok=True)
        beside = self.path.with_name(self.path.name + ".new")
        beside.write_text(value + "\n")
        beside.replace(self.path)
