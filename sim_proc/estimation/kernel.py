"""The estimator tick by tick: a Kalman filter of a robot whose feet stand, roll and are lifted. Compiled."""

from typing import Any, Final

import numpy as np

from sim_proc.estimation.compiled import compiled
from sim_proc.estimation.filtering import correct, error_transition, foothold_derivative, place_foot, spread, update
from sim_proc.estimation.layout import (
    COM,
    DOWN,
    FEET,
    FLOOR_HEIGHT,
    GRAVITY,
    IN_AIR,
    JOINTS,
    N_ERRORS,
    OUT_COM,
    OUT_COM_VELOCITY,
    OUT_JOINTS,
    OUT_LOADS,
    OUT_POSITION,
    OUT_RATE,
    OUT_ROTATION,
    OUT_TIPS,
    OUT_VELOCITY,
    POSITION,
    QUATERNION,
    RADIUS,
    STEPS,
    TARE,
    TICK_S,
    VELOCITY,
    F,
    G,
)
from sim_proc.estimation.motion import kinematics, propagate, roll, rotation_matrix

STANDING: Final = 3.0
"""Ticks after which a foot that came down or slipped has found its place, and moves by rolling alone."""
SLIPPED_M: Final = 0.03
"""A foot this far from where it stood has slipped, and stands in a new place."""
DOWN_N: Final = 30.0
UP_N: Final = 12.0
"""A foot that carries more than the first is down, until it carries less than the second."""
FIRST_TARE_TICK: Final = 4
LAST_TARE_TICK: Final = 7
"""Ticks in the air, 80 to 140 ms after the lift, in which what a foot feels is its sensor's bias."""
TARE_SHARE: Final = 0.25
MOST_TARE_N: Final = 40.0
"""A foot in the air that feels more touches something."""
LEVEL_SHARE: Final = 0.1
"""Share of its error in height that each foothold corrects, as if the floor were level."""


@compiled()
def feel_feet(memory: Any, readings: Any, lifted: Any, loads: Any) -> None:
    """Fill in what the feet carry in a tick, (4,); note which are down, and tare those that are in the air."""
    for leg in range(4):
        total = 0.0
        for step in range(STEPS):
            total -= readings[step, 18 + leg]
        load = total / STEPS - memory[TARE + leg]
        was_down = memory[DOWN + leg] != 0.0
        is_down = load > (UP_N if was_down else DOWN_N) and not lifted[leg]
        memory[DOWN + leg] = min(memory[DOWN + leg] + 1.0, STANDING) if is_down else 0.0
        memory[IN_AIR + leg] = 0.0 if is_down else memory[IN_AIR + leg] + 1.0
        in_air = memory[IN_AIR + leg]
        if lifted[leg] and FIRST_TARE_TICK <= in_air <= LAST_TARE_TICK and abs(load) < MOST_TARE_N:
            share = 1.0 if in_air == FIRST_TARE_TICK and memory[TARE + leg] == 0.0 else TARE_SHARE
            memory[TARE + leg] += share * load
            load -= share * load
        loads[leg] = load


@compiled()
def tell(state: Any, memory: Any, r: Any, means: Any, tips: Any, com: Any, joints: Any, row: Any) -> None:
    """Fill in what is known at the end of a tick, (N_OUT,), but the loads. The centre of mass is remembered."""
    for i in range(3):
        row[OUT_POSITION + i] = state[POSITION + i]
        row[OUT_VELOCITY + i] = state[VELOCITY + i]
        row[OUT_RATE + i] = r[i, 0] * means[3] + r[i, 1] * means[4] + r[i, 2] * means[5]
        row[OUT_COM + i] = state[POSITION + i] + (r[i, 0] * com[0] + r[i, 1] * com[1] + r[i, 2] * com[2])
        dx, dy, dz = com[0] - memory[COM], com[1] - memory[COM + 1], com[2] - memory[COM + 2]
        moved = r[i, 0] * dx + r[i, 1] * dy + r[i, 2] * dz
        row[OUT_COM_VELOCITY + i] = state[VELOCITY + i] + moved / TICK_S
        for j in range(3):
            row[OUT_ROTATION + 3 * i + j] = r[i, j]
        for leg in range(4):
            along = r[i, 0] * tips[leg, 0] + r[i, 1] * tips[leg, 1] + r[i, 2] * tips[leg, 2]
            row[OUT_TIPS + 3 * leg + i] = state[POSITION + i] + along
    wx, wy, wz = row[OUT_RATE], row[OUT_RATE + 1], row[OUT_RATE + 2]
    ax, ay, az = row[OUT_COM] - state[POSITION], row[OUT_COM + 1] - state[POSITION + 1], row[OUT_COM + 2] - state[2]
    row[OUT_COM_VELOCITY] += wy * az - wz * ay
    row[OUT_COM_VELOCITY + 1] += wz * ax - wx * az
    row[OUT_COM_VELOCITY + 2] += wx * ay - wy * ax
    for i in range(3):
        memory[COM + i] = com[i]
    for i in range(12):
        row[OUT_JOINTS + i] = joints[i]
        memory[JOINTS + i] = joints[i]


@compiled("void(f8[::1], f8[:,::1], f8[::1], f8[::1], f8[:,:,::1], b1[:,::1], f8[:,::1])")
def advance(state: Any, covariance: Any, memory: Any, body: Any, readings: Any, lifted: Any, out: Any) -> None:
    """Move state (28,), covariance (27, 27) and memory (27,) on by n ticks with readings (n, steps, 22).

    `lifted` (n, 4) tells which feet are lifted then by plan. `out` (n, N_OUT) gets what is known after each tick. All
    arrays have the order of `layout`.
    """
    work, f, rows = np.empty((G, N_ERRORS)), np.empty((G, F)), np.empty((3, N_ERRORS))
    change, ph, h = np.empty(N_ERRORS), np.empty(N_ERRORS), np.empty(9)
    r, tips, com, offset = np.empty((3, 3)), np.empty((4, 3)), np.empty(3), np.empty(3)
    means, loads = np.empty(6), np.empty(4)
    for tick in range(len(readings)):
        samples = readings[tick]
        joints = samples[STEPS - 1, 6:18]
        propagate(state, body[GRAVITY : GRAVITY + 3], samples, means, r)
        error_transition(r, means, f)
        spread(covariance, f, work, memory[DOWN : DOWN + 4])
        kinematics(body, joints, tips, com)
        feel_feet(memory, samples, lifted[tick], loads)
        for leg in range(4):
            if memory[DOWN + leg] == STANDING:
                roll(state, memory, r, means, joints, leg, body[RADIUS])
        for j in range(N_ERRORS):
            change[j] = 0.0
        for leg in range(4):
            if memory[DOWN + leg] != STANDING:
                continue
            foot = FEET + 3 * leg
            x, y, z = (
                state[foot] - state[POSITION],
                state[foot + 1] - state[POSITION + 1],
                state[foot + 2] - state[POSITION + 2],
            )
            distance = 0.0
            for i in range(3):
                offset[i] = r[0, i] * x + r[1, i] * y + r[2, i] * z
                distance += (tips[leg, i] - offset[i]) ** 2
            if distance > SLIPPED_M**2:
                memory[DOWN + leg] = 1.0
                continue
            for i in range(3):
                foothold_derivative(r, offset, i, h)
                update(covariance, h, leg, tips[leg, i] - offset[i], change, ph)
        correct(state, change)
        rotation_matrix(state[QUATERNION : QUATERNION + 4], r)
        for leg in range(4):
            if 0.0 < memory[DOWN + leg] < STANDING:
                place_foot(state, covariance, r, tips[leg], leg, rows)
            if memory[DOWN + leg] == STANDING - 1.0:
                lift = LEVEL_SHARE * (body[FLOOR_HEIGHT] - state[FEET + 3 * leg + 2])
                state[POSITION + 2] += lift
                for other in range(4):
                    state[FEET + 3 * other + 2] += lift
        tell(state, memory, r, means, tips, com, joints, out[tick])
        for leg in range(4):
            out[tick, OUT_LOADS + leg] = loads[leg]
