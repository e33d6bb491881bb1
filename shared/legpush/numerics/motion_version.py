"""The version of the motions: another one means that the same mission moves otherwise."""

from typing import Final

MOTION_VERSION: Final = 5
"""Raised with each change after which the same mission gives other bits with equal numerics. Such a change also changes
`canaries.json`. Recordings, journals, reports and trainings note it; those that do not are older than the number 2."""
MOTIONS: Final = "motions"
"""Its key among the versions of reports, journals, trainings and recordings."""
