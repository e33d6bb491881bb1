"""The reply of a command: lines for people, or with `--json` one JSON document for programs.

`replying` decides where a command writes, and `document` gives it the document. So a command prints the same lines
whatever it was asked for, and needs no branch for each kind of reader.
"""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import PurePath
from typing import Any, Final, TextIO

import msgspec

from legpush.arguments import OutputOptions


class Reply:
    """The document of the command that runs."""

    def __init__(self) -> None:
        self.value: Any = None
        """Plain data, or records of it; None while the command has said nothing."""


_REPLY: Final[ContextVar[Reply | None]] = ContextVar("reply", default=None)


def document(value: Any) -> None:
    """Give the command that runs its document. The last one counts; without `--json` it is not shown."""
    if (reply := _REPLY.get()) is not None:
        reply.value = value


@contextmanager
def replying(options: OutputOptions) -> Iterator[None]:
    """Let the work within write as these options say.

    With `json`, the lines on standard output go to standard error, and the document is written to standard output at
    the end, also at the end of work that raises `SystemExit`; of work that fails otherwise only if it gave one. With
    `quiet`, the lines go nowhere.
    """
    if not (options.json or options.quiet):
        yield
        return
    reply, before = Reply(), sys.stdout
    token = _REPLY.set(reply)
    with _elsewhere(options.quiet) as stream:
        sys.stdout = stream
        try:
            yield
        finally:
            sys.stdout.flush()
            sys.stdout = before
            _REPLY.reset(token)
            if options.json and reply.value is not None:
                before.write(encode(reply.value))
                before.flush()


@contextmanager
def _elsewhere(quiet: bool) -> Iterator[TextIO]:
    """Yield the stream for the lines that are not to reach standard output."""
    if not quiet:
        yield sys.stderr
        return
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        yield nowhere


def encode(value: Any) -> str:
    """Return a value as an indented JSON document; a number that is not finite is null."""
    plain = msgspec.json.encode(value, enc_hook=_plain)
    return msgspec.json.format(plain, indent=2).decode() + "\n"


def _plain(value: Any) -> Any:
    """Return plain data for a value that JSON does not know: the text of a path, and a number of NumPy as a number."""
    if isinstance(value, PurePath):
        return str(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"Expected a value that JSON can express, got {type(value).__name__}")
