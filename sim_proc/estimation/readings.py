"""What the robot's own sensors read in one physics step, as one row of numbers."""

from typing import Final

GYRO: Final = slice(0, 3)
"""Angular velocity of the trunk, in its frame."""
ACCELERATION: Final = slice(3, 6)
"""Acceleration of the middle of the trunk without that of gravity, in its frame."""
JOINTS: Final = slice(6, 18)
"""Angles of the joints."""
FORCES: Final = slice(18, 22, 1)
"""Vertical forces of the feet on their surroundings: negative while they stand."""
N_READINGS: Final = 22
"""Numbers in a row."""
