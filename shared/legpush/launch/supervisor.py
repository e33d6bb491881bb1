"""Watches over the processes of a mission: waits until each is ready, restarts it if it dies, names it if it hangs."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from time import monotonic
from typing import Final

from legpush.errors import DISK_FULL, INTERRUPTED
from legpush.launch.display import Display
from legpush.launch.last_words import said
from legpush.messages.telemetry import Status
from legpush.patience import SLICE_S, Stopwatch
from legpush.processes.child import Command, Process, describe_exit
from legpush.processes.crew import Crew, Interrupt

SUCCESS: Final = 0
NO_SUCCESS: Final = 1
BAD_INPUT: Final = 2
GAVE_UP: Final = 3

FROZEN_EVERY_S: Final = 0.5
"""Period of the check for frozen processes."""


@dataclass(frozen=True, kw_only=True)
class Limits:
    """The limits beyond which the launcher gives up."""

    ready_s: float = 60.0
    """Longest time in which a running process may show no sign of life."""
    mission_s: float | None = None
    """Longest duration of the whole mission; None for no limit. Time in which a process is frozen does not count."""
    max_restarts: int = 3
    """Most restarts of each process."""


@dataclass(frozen=True)
class Verdict:
    """How the mission ended, with the reason unless it was a success."""

    exit_code: int
    reason: str = ""


@dataclass
class _Post:
    """A role, and the process that has it."""

    process: Process
    absent: Stopwatch
    """Time since the last sign of life."""
    n_restarts: int = 0
    seen: bool = False
    """Whether this process ever showed a sign of life."""
    frozen: bool = False


class Supervisor:
    """Runs the processes of a mission until the leading one is done.

    `is_alive` says whether a role shows its liveliness token. `hear` returns the statuses since the last call.
    `has_result` says whether the leader left the result of the mission. `on_bystander` gets a process of the crew that
    ended and has no part in the mission.
    """

    def __init__(
        self,
        crew: Crew,
        display: Display,
        *,
        is_alive: Callable[[str], bool],
        hear: Callable[[], Iterable[Status]],
        leader: str = "agent",
        limits: Limits | None = None,
        has_result: Callable[[], bool] = lambda: True,
        on_bystander: Callable[[Process], None] = lambda process: None,
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self._crew = crew
        self._display = display
        self._is_alive = is_alive
        self._hear = hear
        self._leader = leader
        self._limits = limits or Limits()
        self._has_result = has_result
        self._on_bystander = on_bystander
        self._clock = clock
        self._posts: dict[str, _Post] = {}
        self._mission = Stopwatch(clock)
        self._until_look = Stopwatch(clock)
        self._last: Status | None = None

    def run(self, commands: Sequence[Command]) -> Verdict:
        """Start the commands, watch until the mission is over, and end all processes that still run."""
        try:
            for command in commands:
                self._posts[command.role] = self._fill(command)
            self._mission.restart()
            return self._watch()
        finally:
            self._display.progress("stopping", None, "", "")
            self._crew.stop()

    def _fill(self, command: Command, n_restarts: int = 0) -> _Post:
        """Start a process."""
        return _Post(self._crew.start(command), Stopwatch(self._clock), n_restarts)

    def _watch(self) -> Verdict:
        """Handle one event or look around once, again and again until there is a verdict."""
        while True:
            event = self._crew.next_event(SLICE_S)
            if isinstance(event, Interrupt):
                return Verdict(INTERRUPTED, f"interrupted by {event.by.name}")
            verdict = self._take_end(event) if isinstance(event, Process) else self._look_around()
            if verdict is not None:
                return verdict

    def _take_end(self, process: Process) -> Verdict | None:
        """Handle a process that ended: end the mission, or start the process again."""
        role, exit_code = process.role, process.exit_code
        if exit_code is None:
            raise ValueError(f"Expected a process that ended, got the running {role}")
        if role not in self._posts:
            self._on_bystander(process)
            return None
        if role == self._leader and exit_code in (SUCCESS, NO_SUCCESS):
            if not self._has_result():
                what = f"the {role} {describe_exit(exit_code)} without a result of the mission"
                return Verdict(GAVE_UP, f"{what}{said(process)}")
            self._show()
            return Verdict(exit_code, self._last.detail if exit_code == NO_SUCCESS and self._last is not None else "")
        if exit_code in (BAD_INPUT, DISK_FULL):
            return Verdict(exit_code, f"the {role} {describe_exit(exit_code)}{said(process)}")
        post, what = self._posts[role], f"the {role} {describe_exit(exit_code)}"
        if post.n_restarts == self._limits.max_restarts:
            return Verdict(GAVE_UP, f"{what} after {post.n_restarts} restarts{said(process)}")
        n_restarts = post.n_restarts + 1
        self._display.notice(
            f"{what}; starting it again ({n_restarts} of {self._limits.max_restarts}){said(process, 3)}"
        )
        self._posts[role] = self._fill(process.command.again(), n_restarts)
        return None

    def _look_around(self) -> Verdict | None:
        """Show progress, note which processes are alive, and give up if a process or the mission takes too long."""
        self._show()
        if self._until_look.tick() >= FROZEN_EVERY_S:
            self._until_look.restart()
            self._look_for_frozen()
        for role, post in self._posts.items():
            post.absent.tick()
            alive = self._is_alive(role)
            post.seen |= alive
            if alive or post.frozen:
                post.absent.restart()
            elif post.absent.elapsed_s > self._limits.ready_s:
                what = "has shown no sign of life for" if post.seen else "did not become ready in"
                return Verdict(
                    GAVE_UP,
                    f"the {role} {what} {self._limits.ready_s:g} s, although it runs (process {post.process.pid})"
                    f"{said(post.process)}",
                )
        return self._check_time()

    def _check_time(self) -> Verdict | None:
        """Give up when the mission takes longer than allowed."""
        limit_s, before_s = self._limits.mission_s, self._mission.elapsed_s
        self._mission.tick()
        if any(post.frozen for post in self._posts.values()):
            self._mission.elapsed_s = before_s
        if limit_s is None or self._mission.elapsed_s <= limit_s:
            return None
        doing = f"; it was {self._last.phase} {self._last.detail}".rstrip() if self._last is not None else ""
        waiting = f", waiting for {self._last.waiting_for}" if self._last is not None and self._last.waiting_for else ""
        return Verdict(GAVE_UP, f"the mission did not end in {limit_s:g} s{doing}{waiting}")

    def _look_for_frozen(self) -> None:
        """Tell the user once of each process that is frozen, and once when it goes on."""
        for role, post in self._posts.items():
            frozen = post.process.is_frozen()
            if frozen != post.frozen:
                post.frozen = frozen
                pid = post.process.pid
                self._display.notice(
                    f"the {role} is frozen; `kill -CONT {pid}` lets it go on" if frozen else f"the {role} goes on"
                )

    def _show(self) -> None:
        """Show the last status of the leader, or the processes that are not ready yet."""
        for status in self._hear():
            if status.header.role == self._leader:
                self._last = status
        missing = [role for role, post in self._posts.items() if not post.seen]
        if self._last is not None:
            last = self._last
            self._display.progress(last.phase, last.fraction, last.detail, last.waiting_for)
        else:
            self._display.progress("starting", None, "", ", ".join(missing))
