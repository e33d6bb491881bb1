"""Stand-ins for simulator and planner: no physics, but a state that depends on every motion and on their order."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread
from time import monotonic
from typing import Literal
from zlib import crc32

from legpush.bus.bus import Bus
from legpush.bus.endpoints import in_directory
from legpush.bus.faults import Faults
from legpush.errors import MotionError
from legpush.geometry import Pose2
from legpush.history.entries import Opened
from legpush.lockstep.client import PastStep, SimLink
from legpush.lockstep.server import serve_actions
from legpush.lockstep.simulator import Stepper
from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION, Role
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Follow, Motion, Outcome, Push, Reset, Walk
from legpush.numerics.motion_version import MOTION_VERSION, MOTIONS
from legpush.patience import Patience
from legpush.plans.client import PlanLink
from legpush.plans.planner import Interrupted, MakePlans
from legpush.plans.server import serve_plans
from tests.legpush.examples import RESET, TRACE, WORLD

RUN = "test"
IMPATIENT = Patience(deadline_s=20.0, resend_s=0.02)
LEGS: tuple[Literal["FL", "FR"], ...] = ("FL", "FR")


class Clock:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def eventually(holds: Callable[[], bool], within_s: float = 10.0) -> bool:
    """Whether `holds` comes true before the deadline."""
    deadline, pause = monotonic() + within_s, Event()
    while not holds():
        if monotonic() > deadline:
            return False
        pause.wait(0.005)
    return True


class FakeStepper:
    """The CRC of its state chains over all motions since the last reset."""

    def __init__(self) -> None:
        self.performed: list[Motion] = []
        self._crc = 0
        self._has_path = False

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        if isinstance(motion, Walk) and not self._has_path:
            raise MotionError("Expected a follow before the first walk")
        self._has_path = isinstance(motion, Follow) or (self._has_path and not isinstance(motion, Reset))
        self._crc = crc32(codec.encode(motion), 0 if isinstance(motion, Reset) else self._crc)
        self.performed.append(motion)
        return Outcome(world=WORLD, state_crc=self._crc, trace=TRACE if with_trace else None)


def one_plan(make_plan: Callable[[PlanQuery], Plan]) -> MakePlans:
    """A planner that has no better plans."""

    def make_plans(query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
        del interrupted
        yield make_plan(query)

    return make_plans


def fake_plan(query: PlanQuery) -> Plan:
    """A straight line, and a number that depends on the seed."""
    return Plan(status="exact", reason="", waypoints=(query.start, query.goal), n_iterations=query.seed)


def mission(n_cycles: int = 20) -> list[Motion]:
    """A reset, a path, walking, and pushes of which no two are alike."""
    path = Follow(waypoints=(Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0), Pose2(x_m=1.0, y_m=0.0, yaw_rad=0.0)))
    pushes = [Push(w1=0.5, w2=i / n_cycles, leg=LEGS[i % 2], depth_m=0.1) for i in range(n_cycles)]
    return [RESET, path, Walk(), Walk(), *pushes]


def crc_after(motions: list[Motion]) -> int:
    """State of a simulator that was asked for nothing but these motions, once each."""
    stepper = FakeStepper()
    return [stepper.perform(motion, with_trace=False).state_crc for motion in motions][-1]


def opened(seed: int = 3) -> Opened:
    """How a journal of the test run begins."""
    versions = {MOTIONS: str(MOTION_VERSION)}
    return Opened(protocol=PROTOCOL_VERSION, run=RUN, seed=seed, versions=versions, began_unix_s=0.0)


class Agent:
    """The links of an agent."""

    def __init__(self, opened_bus: Bus, patience: Patience) -> None:
        self.bus = opened_bus
        self.stop = Event()
        self.waits: list[str] = []
        self.sim = SimLink(opened_bus, "main", stop=self.stop, patience=patience, on_wait=self.waits.append)
        self.planner = PlanLink(opened_bus, stop=self.stop, patience=patience, on_wait=self.waits.append)
        self.past: list[PastStep] = []
        self.sim.begin()
        opened_bus.announce()

    def do(self, motions: Iterable[Motion]) -> int:
        """Carry out the motions as the next steps; returns the last CRC."""
        for motion in motions:
            self.past.append(PastStep(motion, self.sim.step(motion, self.past).state_crc))
        return self.past[-1].state_crc


@contextmanager
def agent(directory: Path, faults: Faults | None = None, patience: Patience = IMPATIENT) -> Iterator[Agent]:
    """An agent that is ready to ask."""
    with bus(directory, "agent", faults=faults) as opened_bus:
        yield Agent(opened_bus, patience)


@contextmanager
def bus(directory: Path, role: Role, name: str = "main", faults: Faults | None = None) -> Iterator[Bus]:
    """A bus of the test run on the unix sockets in `directory`."""
    with Bus(RUN, role, name, in_directory(directory, role), faults) as opened:
        yield opened


@contextmanager
def sim(directory: Path, stepper: Stepper | None = None, faults: Faults | None = None) -> Iterator[Bus]:
    """A simulator that serves in a thread."""
    stop = Event()
    with bus(directory, "sim", faults=faults) as opened:
        thread = Thread(target=serve_actions, args=(opened, stepper or FakeStepper(), stop))
        thread.start()
        try:
            yield opened
        finally:
            stop.set()
            thread.join()


@contextmanager
def planner(
    directory: Path,
    make_plan: Callable[[PlanQuery], Plan] = fake_plan,
    faults: Faults | None = None,
    make_plans: MakePlans | None = None,
) -> Iterator[Bus]:
    """A planner that serves in a thread; `make_plans` is one that improves its plans."""
    stop = Event()
    with bus(directory, "planner", faults=faults) as opened:
        thread = Thread(target=serve_plans, args=(opened, make_plans or one_plan(make_plan), stop))
        thread.start()
        try:
            yield opened
        finally:
            stop.set()
            thread.join()
