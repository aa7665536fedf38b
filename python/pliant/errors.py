"""Errors, described in one sentence: where they occurred, what is wrong, and what would be right."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any


class Failure(Exception):
    """An operation failed. The text is for people; the attributes are for programs."""

    #: "input", "failed" or "cancelled"
    kind: str = "failed"
    #: The file that the error is in; "" if none.
    file: str
    #: The line in the file, from 1; 0 if unknown.
    line: int
    #: The key in the file; "" if unknown.
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


class MissingFile(FileNotFoundError, InputError):
    """A file that was named is not there: what Python itself raises, with `errno` and `filename`."""

    def __init__(self, message: str, file: str = "", line: int = 0, key: str = "") -> None:
        FileNotFoundError.__init__(self, errno.ENOENT, os.strerror(errno.ENOENT), file)
        self._message = message
        self.file = file
        self.line = line
        self.key = key

    def __str__(self) -> str:
        return self._message

    def __reduce__(self) -> tuple[Any, ...]:
        return Failure.__reduce__(self)


class Cancelled(Failure):
    """The work was cancelled by a progress callable."""

    kind = "cancelled"


#: How the library tells that a file is not there.
_MISSING = ": no such file"


def input_error(message: str, file: str = "", line: int = 0, key: str = "") -> InputError:
    """The error for what the library tells: one about a file that it does not find is a `MissingFile`. A file that a
    robot file names is a mistake in that one, at a line and a key."""
    named = message[: -len(_MISSING)] if message.endswith(_MISSING) else ""
    if named and not line and not key and (named == file or (not file and ": " not in named)):
        return MissingFile(message, named)
    return InputError(message, file, line, key)


@contextmanager
def arguments_for_options(arguments: Mapping[str, str]) -> Iterator[None]:
    """In the errors of what is done, options of the command line become the arguments of Python that they stand for."""
    try:
        yield
    except Failure as error:
        message = str(error)
        for option, argument in arguments.items():
            message = message.replace(option, argument)
        if message == str(error):
            raise
        raise type(error)(message, error.file, error.line, error.key) from None
