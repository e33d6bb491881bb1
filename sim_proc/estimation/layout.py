"""Where the numbers of the estimator lie in its arrays, and how long its ticks are."""

from typing import Final

N_ERRORS: Final = 27
"""Numbers of an error: position, velocity, attitude, gyroscope, accelerometer, feet."""
P, V, A, G, B, F = 0, 3, 6, 9, 12, 15
"""Where each of them begins."""
POSITION, VELOCITY, QUATERNION, GYRO_BIAS, ACCELERATION_BIAS, FEET, N_STATE = 0, 3, 6, 10, 13, 16, 28
"""Where the parts of a state begin, and its size."""
JOINTS, IN_AIR, DOWN, TARE, COM, N_MEMORY = 0, 12, 16, 20, 24, 27
"""Where the parts of the memory begin: joint angles before, ticks in the air, ticks for which each foot is down up to
`STANDING`, what the feet feel too little, centre of mass before."""
(
    OUT_POSITION,
    OUT_ROTATION,
    OUT_VELOCITY,
    OUT_RATE,
    OUT_TIPS,
    OUT_LOADS,
    OUT_COM,
    OUT_COM_VELOCITY,
    OUT_JOINTS,
    N_OUT,
) = 0, 3, 12, 15, 18, 30, 34, 37, 40, 52
"""Where the parts of an estimate begin."""
HIPS, OFFSETS, UPPER, LOWER, RADIUS, GRAVITY, FLOOR_HEIGHT, MASS, MOMENT, LINKS, N_BODY = (
    0,
    12,
    16,
    17,
    18,
    19,
    22,
    23,
    24,
    27,
    75,
)
"""Where the numbers of the robot begin: origins of the hips, signed offsets of the legs, lengths, radius of a foot,
gravity, height of a standing foot, mass, mass times centre of the trunk, and of each of twelve links its mass and mass
times centre."""

STEP_S: Final = 0.002
STEPS: Final = 10
TICK_S: Final = STEP_S * STEPS
