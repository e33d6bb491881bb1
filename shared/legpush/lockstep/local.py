"""A world in this process: a simulator and a planner that are called as functions, without a bus."""

from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from weakref import WeakValueDictionary

from legpush.errors import BrokenEpisodeError, ConfigError
from legpush.history.steps import PlanRecord, StepRecord
from legpush.lockstep.carry_out import carry_out, kind_of
from legpush.lockstep.simulator import Stepper
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome, Reset
from legpush.plans.planner import Interrupted, MakePlans
from legpush.plans.search import search_plans

_OWNERS: WeakValueDictionary[int, object] = WeakValueDictionary()
"""The environment that steps a simulator, by the identity of the simulator, which lives as long as its owner."""


def never() -> bool:
    """Tell a search that it may go on."""
    return False


class LocalWorld:
    """A `World` without other processes; its trajectories equal those over the bus, bit for bit."""

    def __init__(
        self,
        simulator: Stepper,
        make_plans: MakePlans | None = None,
        *,
        on_record: Callable[[StepRecord | PlanRecord], None] | None = None,
        interrupted: Interrupted = never,
    ) -> None:
        """`make_plans` is the planner; a world that is only stepped needs none.

        `on_record` gets every step and every plan, in order. `interrupted` is asked during a search whether to stop.
        """
        self._simulator = simulator
        self._broken = ""
        """Why only a reset goes on."""
        self._make_plans = make_plans
        self._record = on_record
        self._interrupted = interrupted
        self._query: PlanQuery | None = None
        self._search: Iterator[Plan] = iter(())
        self._plans: list[Plan] = []

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        """Carry out one motion.

        Raises:
            MotionError: The motion cannot be carried out; the state is as it was.
            ScenarioError: The world of a reset cannot be built; the state is as it was.
            BrokenEpisodeError: The simulator failed in this motion, or in one since the last reset.
        """
        if self._broken and not isinstance(motion, Reset):
            raise BrokenEpisodeError(f"{self._broken}; expected a reset after that, got {kind_of(motion)}")
        try:
            outcome = carry_out(self._simulator, motion, with_trace=with_trace)
        except BrokenEpisodeError as error:
            self._broken = str(error)
            raise
        self._broken = ""
        if self._record is not None:
            self._record(StepRecord(motion, outcome))
        return outcome

    def fork(self) -> "LocalWorld":
        """Return a copy with the present state, which goes its own way: it has no planner, and nobody records it.

        Raises:
            ConfigError: The simulator cannot be copied.
        """
        try:
            return LocalWorld(deepcopy(self._simulator))
        except TypeError as error:
            raise ConfigError(f"Expected a simulator that can be copied, got {self._simulator!r} ({error})") from error

    def claim(self, owner: object) -> None:
        """Reserve the simulator for `owner`, for as long as it lives or until it is released.

        Raises:
            ConfigError: Another owner has it: two of them would step one world without noticing.
        """
        other = _OWNERS.setdefault(id(self._simulator), owner)
        if other is not owner:
            raise ConfigError(
                f"Expected a simulator of its own for each {type(owner).__name__}, got one that another "
                f"{type(other).__name__} steps already"
            )

    def release(self, owner: object) -> None:
        """End the reservation of `owner`, if it has one."""
        if _OWNERS.get(id(self._simulator)) is owner:
            del _OWNERS[id(self._simulator)]

    def plan(self, query: PlanQuery) -> Plan:
        """Return the planner's first answer to a query.

        Raises:
            ConfigError: This world has no planner.
        """
        if self._make_plans is None:
            raise ConfigError("Expected a world with a planner, got one that can only be stepped")
        self._query, self._plans = query, []
        self._search = search_plans(self._make_plans, query, self._interrupted)
        return self.revision(0)

    def revision(self, revision: int) -> Plan:
        """Return the plan with this number for the last query, 0 the first; the last plan if there are no more.

        Raises:
            ConfigError: Nothing was asked before.
        """
        while len(self._plans) <= revision and (plan := next(self._search, None)) is not None:
            self._plans.append(plan)
        if self._query is None or not self._plans:
            raise ConfigError("Expected a query before a revision of its plan")
        plan = self._plans[min(revision, len(self._plans) - 1)]
        if self._record is not None:
            self._record(PlanRecord(self._query, plan))
        return plan

    def cancel_plan(self) -> None:
        """End the search for better plans."""
        self._search = iter(())

    def tell_reward(self, terms: Mapping[str, float]) -> None:
        """Do nothing: nobody watches this world."""
