"""What a result was computed with: version of the motions and numerics. Says why other bits are no surprise."""

from collections.abc import Mapping
from typing import Final, NamedTuple

from legpush.errors import LegpushError, OtherVersionError
from legpush.numerics.current import current
from legpush.numerics.motion_version import MOTION_VERSION, MOTIONS

NUMERICS: Final = "numerics"
"""Key of the name of the numerics, such as `x86-64-v3/1a2b3c4d`, among the versions."""


class ComputedWith(NamedTuple):
    """What a result was computed with; None for what files of earlier versions did not note."""

    motions: str | None = None
    """The version of the motions."""
    numerics: str | None = None
    """The name of the numerics."""

    def other_version(self) -> str:
        """Return that the motions had another version than here; empty if they had this one."""
        if self.motions == str(MOTION_VERSION):
            return ""
        recorded = "before motions had a version" if self.motions is None else f"with motion version {self.motions}"
        return f"other version: recorded {recorded}, here {MOTION_VERSION}"

    def other_numerics(self, here: str) -> str:
        """Return that the numerics were others than those of this name; empty if they were these."""
        if self.numerics == here:
            return ""
        return f"other numerics: recorded with {self.numerics or 'numerics that were not noted'}, here {here}"


def computing_with() -> str:
    """Return what this process computes with, in words: equal ones lead equal motions to equal states."""
    return f"{current().name}, {MOTIONS} {MOTION_VERSION}"


def computed_with(versions: Mapping[str, str | None]) -> ComputedWith:
    """Return what the versions of a report, journal or training say."""
    return ComputedWith(versions.get(MOTIONS), versions.get(NUMERICS))


def told(error: LegpushError, recorded: ComputedWith, still: str) -> LegpushError:
    """Return the error of a difference as what it is, if it came from another version or from other numerics.

    `still` says what can be done with a file of another version.
    """
    if other := recorded.other_version():
        return OtherVersionError(f"{other}; {still}")
    if other := recorded.other_numerics(current().name):
        return type(error)(f"{other}; {error}")
    return error
