"""What goes wrong, in one sentence: where, what, and what would be right."""

from __future__ import annotations

from typing import Any


class Failure(Exception):
    """The work did not succeed. Its text is for people; the attributes are for programs."""

    #: "input", "failed" or "cancelled"
    kind: str = "failed"
    #: The file that the error is in; "" if it is in none.
    file: str
    #: Its line, from 1; 0 where that is not known.
    line: int
    #: The key there; "" where that is not known.
    key: str

    def __init__(self, message: str, file: str = "", line: int = 0, key: str = "") -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.key = key

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.file, self.line, self.key)


class InputError(Failure, ValueError):
    """A file, a key or an argument is wrong."""

    kind = "input"


class Cancelled(Failure):
    """A progress callable asked for an end."""

    kind = "cancelled"
