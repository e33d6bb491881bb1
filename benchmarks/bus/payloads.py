"""The messages of the round trips: a `Walk` as question, and observations of about a given size as answers."""

from typing import Final

import numpy as np
from msgspec.structs import replace

from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION, Header, Role
from legpush.messages.stepping import Action, Motion, Observation, Outcome, Reset, Trace, Walk
from legpush.scenarios.file import load_scenario
from legpush.soak.stub_simulator import StubSimulator

N_POSITIONS: Final = 26
"""Numbers in a row of `qpos`."""


class SizedSimulator:
    """A `Stepper` in whose world nothing moves: every answer has about `n_bytes` bytes, if need be by a trace."""

    def __init__(self, n_bytes: int) -> None:
        first = StubSimulator().perform(reset(), with_trace=False)
        rng = np.random.default_rng(0)
        n_rows = max(0, round((n_bytes - len(_answer(first))) / (9 * N_POSITIONS + 5)))
        rows = tuple(tuple(row) for row in rng.standard_normal((n_rows, N_POSITIONS)).tolist())
        self.outcome: Final = replace(first, trace=_trace(rows) if rows else None)

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Return the outcome."""
        del motion, with_trace
        return self.outcome


def reset() -> Reset:
    """Return how an episode begins."""
    return Reset(scenario=load_scenario("push"), seed=0)


def question() -> bytes:
    """Return the bytes of a `Walk`."""
    return codec.encode(Action(header=_header("agent"), episode=1, step=1, motion=Walk()))


def answer(n_bytes: int) -> bytes:
    """Return the bytes of an observation of about this size."""
    return _answer(SizedSimulator(n_bytes).outcome)


def _answer(outcome: Outcome) -> bytes:
    return codec.encode(
        Observation(header=_header("sim"), agent_incarnation="0" * 12, episode=1, step=1, outcome=outcome)
    )


def _header(role: Role) -> Header:
    return Header(protocol=PROTOCOL_VERSION, run="bench", role=role, name="main", incarnation="0" * 12, sequence=1)


def _trace(rows: tuple[tuple[float, ...], ...]) -> Trace:
    """A trace with generalized positions alone."""
    return Trace(
        tick=tuple(range(len(rows))),
        qpos=rows,
        roll_pitch_rad=(),
        tips_m=(),
        contact_forces_n=(),
        com_m=(),
        zmp_m=(),
        support_margin_m=(),
    )
