"""A simulator without physics: `python -m legpush.soak.stub_simulator`. Its state is the chain of its motions."""

import sys
from zlib import crc32

from legpush.lockstep.sim_host import run_simulators
from legpush.messages import codec
from legpush.messages.stepping import BoxState, Imu, Motion, Outcome, Reset, TrunkState, WorldState

_NOWHERE = (0.0, 0.0, 0.0)
_LEVEL = (1.0, 0.0, 0.0, 0.0)


def chained(crc: int, motion: Motion) -> int:
    """Return the state after a motion: a step that is lost, repeated or altered gives another one."""
    return crc32(codec.encode(motion), 0 if isinstance(motion, Reset) else crc)


class StubSimulator:
    """A `Stepper` in whose world nothing moves."""

    def __init__(self) -> None:
        self._crc = 0
        self._tick = 0

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Count the motion."""
        del with_trace
        self._tick = 0 if isinstance(motion, Reset) else self._tick + 1
        self._crc = chained(self._crc, motion)
        return Outcome(world=_world(self._tick), state_crc=self._crc)


def _world(tick: int) -> WorldState:
    """A robot and a box at the origin."""
    return WorldState(
        tick=tick,
        trunk=TrunkState(
            position_m=_NOWHERE,
            orientation_wxyz=_LEVEL,
            linear_velocity_m_s=_NOWHERE,
            angular_velocity_rad_s=_NOWHERE,
        ),
        joint_positions_rad=(0.0,) * 12,
        joint_velocities_rad_s=(0.0,) * 12,
        tips_m=(_NOWHERE,) * 4,
        foot_forces_n=(0.0,) * 4,
        imu=Imu(orientation_wxyz=_LEVEL, angular_velocity_rad_s=_NOWHERE, linear_acceleration_m_s2=_NOWHERE),
        box=BoxState(position_m=_NOWHERE, orientation_wxyz=_LEVEL),
        n_footsteps=0,
        fallen=False,
        path=None,
        push=None,
        appeared=(),
    )


if __name__ == "__main__":
    sys.exit(run_simulators(lambda _: StubSimulator()))
