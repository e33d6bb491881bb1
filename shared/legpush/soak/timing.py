"""Measures how soon the end of a process is noticed, and how long it takes until its successor works, part by part."""

import time
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import Final

import psutil
from msgspec import Struct

from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints
from legpush.runs.live_runs import find_live_runs
from legpush.soak.mission import RunningMission
from legpush.soak.table import FaultRole

IMPORTED: Final = "listening on"
"""Words in the log of a process that has imported its modules and opens its session."""
REDONE: Final = ("going on live", "was led through")
"""Words in the log of the agent when it has taken its past from the journal, and when it has led a simulator."""
STARTING_AGAIN: Final = "starting it again"
LONGEST_S: Final = 60.0
LOOK_S: Final = 0.002


class Times(Struct, frozen=True, kw_only=True):
    """Seconds after a kill; None for what did not happen or does not apply."""

    noticed_by_peers_s: float | None
    """Until the liveliness token of the process was gone, for another process on the bus."""
    noticed_by_launcher_s: float | None
    """Until the launcher said that it starts the process again."""
    spawn_s: float | None
    """From there until the new process was there."""
    imports_s: float | None
    """From there until it had imported its modules."""
    connect_s: float | None
    """From there until its liveliness token was up: it has loaded the rest, such as OMPL, and is ready."""
    redo_s: float | None
    """From there until it had done its past again; None if it has none."""
    resumed_s: float | None
    """From the kill until the first new answer was in the journal; None if nothing was asked any more."""


@dataclass
class _Log:
    """The log of a process from now on."""

    path: Path
    begin: int = 0

    def has(self, *words: str) -> bool:
        with self.path.open("rb") as file:
            file.seek(self.begin)
            text = file.read().decode(errors="replace")
        return any(word in text for word in words)


class KillWatch:
    """Watches a mission from before a kill on; a context manager."""

    def __init__(self, mission: RunningMission, role: FaultRole) -> None:
        self._mission = mission
        self._role = role
        run = next(run for run in find_live_runs() if run.pid == mission.launcher.pid)
        self._bus = Bus(run.run, "launcher", "soak", Endpoints(connect=run.connect))
        self._tokens: list[tuple[float, bool]] = []

    def __enter__(self) -> "KillWatch":
        self._bus.__enter__()
        self._bus.watch(self._take)
        self._mission.wait(lambda: self._tokens, f"the liveliness token of the {self._role}")
        logs = self._mission.out / "logs"
        self._own, self._agents = (_log(logs / f"{name}.log") for name in (self._role, "agent"))
        return self

    def __exit__(self, *_: object) -> None:
        self._bus.__exit__(None, None, None)

    def kill(self, victim: psutil.Process) -> float:
        """Kill the process; returns when."""
        self._agents = _log(self._agents.path)
        self._own = _log(self._own.path)
        victim.kill()
        return monotonic()

    def times(self, killed_s: float, victim: psutil.Process) -> Times:
        """Watch until work goes on, or the mission ends."""
        seen: dict[str, float] = {}
        n_answers: int | None = None
        mission, until = self._mission, monotonic() + LONGEST_S
        while monotonic() < until and "resumed" not in seen and mission.launcher.poll() is None:
            time.sleep(LOOK_S)
            if "spawned" not in seen:
                if (since_s := _created_s(mission, self._role, victim.pid)) is not None:
                    seen["spawned"] = max(since_s, killed_s)
            elif "imported" not in seen:
                if self._own.has(IMPORTED):
                    seen["imported"] = monotonic()
            else:
                if "redone" not in seen and self._agents.has(*REDONE):
                    seen["redone"] = monotonic()
                mission.journal.look()
                if any(alive for at_s, alive in self._tokens if at_s > killed_s):
                    n_answers = mission.journal.n_answers if n_answers is None else n_answers
                    if mission.journal.n_answers > n_answers:
                        seen["resumed"] = monotonic()
        gone = next((at_s for at_s, alive in self._tokens if not alive and at_s > killed_s), None)
        up = next((at_s for at_s, alive in self._tokens if alive and at_s > killed_s), None)
        said = next((at_s for at_s, line in mission.lines if at_s > killed_s and STARTING_AGAIN in line), None)
        spawned, imported, redone = (seen.get(name) for name in ("spawned", "imported", "redone"))
        return Times(
            noticed_by_peers_s=_between(killed_s, gone),
            noticed_by_launcher_s=_between(killed_s, said),
            spawn_s=_between(said, spawned),
            imports_s=_between(spawned, imported),
            connect_s=_between(imported, up),
            redo_s=_between(up, redone) if self._role != "planner" else None,
            resumed_s=_between(killed_s, seen.get("resumed")),
        )

    def _take(self, role: str, name: str, incarnation: str, alive: bool) -> None:
        if role == self._role:
            self._tokens.append((monotonic(), alive))


def _log(path: Path) -> _Log:
    return _Log(path, path.stat().st_size if path.exists() else 0)


def _created_s(mission: RunningMission, role: FaultRole, before: int) -> float | None:
    """When the successor of a process was there, as monotonic time; None while there is none."""
    try:
        for process in psutil.Process(mission.launcher.pid).children(recursive=True):
            if process.pid != before and f"{role}_proc" in process.cmdline():
                return monotonic()
    except psutil.Error:
        pass
    return None


def _between(begin_s: float | None, end_s: float | None) -> float | None:
    return None if begin_s is None or end_s is None else round(max(end_s - begin_s, 0.0), 4)
