"""A terminal that hands over every key as it is pressed."""

import contextlib
import os
import select
import termios
import tty


class NoTerminalError(OSError):
    """There is no terminal to read keys from, or it has gone."""


class RawTerminal:
    """Keys without echo and without waiting for a line; `restore` puts the terminal back as it was.

    Signals (Ctrl-C) stay what they are.

    Raises
    ------
    NoTerminalError: if the file is no terminal.
    """

    def __init__(self, file: int = 0) -> None:
        if not os.isatty(file):
            raise NoTerminalError("standard input is no terminal: keys can be read only from a terminal of its own")
        self._file = file
        self._before = termios.tcgetattr(file)
        tty.setcbreak(file, termios.TCSANOW)

    def read(self) -> bytes:
        """What has been typed since the last call, maybe nothing; does not wait.

        Raises
        ------
        NoTerminalError: if the terminal has gone.
        """
        if not select.select([self._file], [], [], 0.0)[0]:
            return b""
        try:
            data = os.read(self._file, 65536)
        except OSError as error:
            raise NoTerminalError(f"the terminal has gone: {error.strerror}") from error
        if not data:
            raise NoTerminalError("the terminal has gone")
        return data

    def restore(self) -> None:
        """Put the terminal back as it was; harmless if it has gone."""
        with contextlib.suppress(termios.error):
            termios.tcsetattr(self._file, termios.TCSANOW, self._before)
