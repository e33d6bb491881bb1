"""CRC-32 of the state of a simulation, by which runs are compared bit for bit."""

import zlib
from typing import Final

import msgspec
import numpy as np

from legpush.realism.reality import Reality
from legpush.scene.robot import RobotSpec
from sim_proc.headless import mujoco

STATE: Final = mujoco.mjtState.mjSTATE_INTEGRATION
"""All that the next step depends on."""


def crc_of_numbers(robot: RobotSpec, reality: Reality) -> int:
    """CRC-32 of the robot as it is sent: in MessagePack, with every number of the type that it is read as.

    The numbers of the episode are added if they differ from what is assumed and known.
    """
    crc = zlib.crc32(msgspec.msgpack.encode(msgspec.convert(msgspec.to_builtins(robot), RobotSpec)))
    return crc if reality.ideal else zlib.crc32(msgspec.msgpack.encode(reality), crc)


def crc_of_state(model: mujoco.MjModel, data: mujoco.MjData, under_way: bytes, numbers_crc: int) -> int:
    """CRC-32 of a state of MuJoCo and of what else is under way, which begins with that of the numbers."""
    state = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, state, STATE)
    return zlib.crc32(under_way, zlib.crc32(state.tobytes(), numbers_crc))
