"""Errors become one line and an exit code, and a full disk has a code of its own wherever it is met."""

import errno
import os
from contextlib import suppress

import pytest

from legpush.errors import (
    DISK_FULL,
    INTERRUPTED,
    ConfigError,
    DiskFullError,
    LegpushError,
    PeerError,
    PluginError,
    RecordingError,
    code_of,
    exit_code_of,
    is_disk_full,
    one_line,
)


def caused(error: LegpushError, *causes: BaseException) -> LegpushError:
    """The error as it is raised from its cause, that from the next one, and so on."""
    above: BaseException = error
    for cause in causes:
        above.__cause__ = cause
        above = cause
    return error


def interrupted() -> None:
    raise KeyboardInterrupt


def system_error(number: int) -> OSError:
    return OSError(number, os.strerror(number))


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT])
@pytest.mark.parametrize("kind", [LegpushError, ConfigError, RecordingError])
def test_an_error_that_a_full_disk_caused_has_the_code_of_a_full_disk(kind: type[LegpushError], number: int) -> None:
    assert code_of(caused(kind("no"), system_error(number))) == DISK_FULL
    assert code_of(caused(kind("no"), RecordingError("no"), system_error(number))) == DISK_FULL
    assert code_of(system_error(number)) == DISK_FULL
    assert code_of(caused(kind("no"), DiskFullError("no"))) == DISK_FULL


def test_an_error_that_an_interrupt_caused_is_an_interrupt_and_is_not_printed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """As pybind11 makes one: a module that is interrupted while it is imported could not be initialized."""
    error = caused(PluginError("no"), ImportError("initialization failed"), ImportError("no"), KeyboardInterrupt())

    def fail() -> int:
        raise error

    assert code_of(error) == exit_code_of(fail) == INTERRUPTED
    assert capsys.readouterr().err == ""


def test_a_full_disk_after_an_interrupt_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    """What was interrupted could not be saved: the user has to know."""

    def work() -> int:
        try:
            interrupted()
        except KeyboardInterrupt:
            raise DiskFullError("no space") from system_error(errno.ENOSPC)
        return 0

    assert exit_code_of(work) == DISK_FULL
    assert capsys.readouterr().err == "error: no space\n"


@pytest.mark.parametrize("number", [errno.EACCES, errno.EROFS, errno.ENOENT, errno.EFBIG])
def test_another_error_of_the_system_keeps_the_code_of_its_kind(number: int) -> None:
    assert code_of(caused(ConfigError("no"), system_error(number))) == 2
    assert code_of(caused(PeerError("no"), system_error(number))) == 3
    assert not is_disk_full(system_error(number))


def test_the_exit_code_is_that_of_the_work_or_of_its_error(capsys: pytest.CaptureFixture[str]) -> None:
    def fail(error: BaseException) -> int:
        raise error

    assert exit_code_of(lambda: 7) == 7
    assert exit_code_of(lambda: fail(ConfigError("a\nb"))) == 2
    assert exit_code_of(lambda: fail(system_error(errno.ENOSPC))) == DISK_FULL
    assert capsys.readouterr().err == "error: a\\nb\nerror: [Errno 28] No space left on device\n"
    for error in (system_error(errno.EACCES), ValueError("x")):
        with pytest.raises(type(error)):
            exit_code_of(lambda error=error: fail(error))  # type: ignore[misc]
    assert capsys.readouterr().err == ""


def test_control_characters_are_shown_and_not_obeyed() -> None:
    assert (
        one_line("ä \x1b]8;;http://x\x07[link] \x9b31m\u202e\r") == "ä \\x1b]8;;http://x\\x07[link] \\x9b31m\\u202e\\r"
    )


def test_a_full_disk_under_standard_error_does_not_hide_the_exit_code(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> int:
        raise DiskFullError("Expected to write the journal")

    with open("/dev/full", "w", buffering=1) as full:
        monkeypatch.setattr("sys.stderr", full)
        assert exit_code_of(fail) == DISK_FULL
        monkeypatch.undo()
        with suppress(OSError):
            full.close()


@pytest.mark.parametrize(
    ("number", "code"), [(errno.EROFS, 2), (errno.EACCES, 2), (errno.ENOTDIR, 2), (errno.EMFILE, 3), (errno.EIO, 3)]
)
def test_an_error_of_the_system_that_names_a_file_is_one_line(
    number: int, code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail() -> int:
        raise OSError(number, os.strerror(number), "runs/a\nb")

    assert exit_code_of(fail) == code
    assert capsys.readouterr().err == f"error: runs/a\\nb: {os.strerror(number)}\n"


def test_an_error_with_several_parts_has_a_line_for_each(capsys: pytest.CaptureFixture[str]) -> None:
    def fail() -> int:
        raise ConfigError("first", "a\nb")

    assert exit_code_of(fail) == 2
    assert capsys.readouterr().err == "error: first\n       a\\nb\n"
    assert str(ConfigError("first", "second")) == "first\nsecond"
