"""The canary: one short push cycle, whose CRC shows whether this process computes the same bits as another one."""

from functools import cache
from typing import Final, cast

from legpush.lockstep.simulator import Stepper
from legpush.messages.stepping import Push, Reset
from legpush.plugins import load_plugin
from legpush.scenarios.file import load_scenario

PROFILE: Final = "native"
"""The numerics profile of this process."""


@cache
def canary() -> str:
    """Return the CRC of the simulator's state after one push, eight hexadecimal digits; computed once per process."""
    simulator = cast(Stepper, load_plugin("legpush.simulators", "mujoco")())
    simulator.perform(Reset(scenario=load_scenario("push"), seed=0), with_trace=False)
    outcome = simulator.perform(Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05), with_trace=False)
    return f"{outcome.state_crc:08x}"
