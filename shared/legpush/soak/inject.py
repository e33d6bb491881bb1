"""Brings a fault into a running mission: by a signal, on a link, or by the switch of a fault within a process."""

import json
import signal
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from time import monotonic, sleep
from typing import Final, cast
from zlib import crc32

import numpy as np
import psutil

from legpush.soak.in_child import CELL_FILE, HARMED, LINK_FAULTS, MESSAGE_FAULTS, SWITCH, proxy_path, target_path
from legpush.soak.mission import RunningMission
from legpush.soak.proxy import LinkFault, LinkProxy
from legpush.soak.table import Cell, FaultRole

SIGNALS: Final = {"kill": signal.SIGKILL, "terminate": signal.SIGTERM}
FREEZES_S: Final = {"freeze_short": 1.0, "freeze_long": 4.0}
"""Shorter and longer than the lease of a link, 2 s."""
LINK_FAULTS_S: Final = {"cut": 1.0, "stall": 4.0, "delay": 2.0, "slow_consumer": 2.0, "corrupt": 1.5}
MESSAGE_FAULTS_S: Final = 2.0
CLOCK_S: Final = 1.0
"""How long the clock stays where it jumped."""
LONGER_S: Final = 20.0
"""How much longer a fault may last that has met nothing yet."""
LOOK_S: Final = 0.02


class Injector:
    """The fault of one cell."""

    def __init__(self, cell: Cell, folder: Path | None, proxies: dict[FaultRole, LinkProxy]) -> None:
        self.cell = cell
        self.folder = folder
        self._proxies = proxies

    @property
    def has_harmed(self) -> bool:
        """Whether the fault has met anything, such as a byte that it could change."""
        if self.cell.kind == "corrupt":
            return any(proxy.n_flips for proxy in self._harmed())
        if self.cell.kind in MESSAGE_FAULTS and self.folder is not None:
            return (self.folder / HARMED).exists()
        return True

    def strike(self, mission: RunningMission, victim: psutil.Process) -> None:
        """Bring the fault into the mission, or into the process of its role, and end it after its time."""
        kind = self.cell.kind
        if kind in SIGNALS:
            victim.send_signal(SIGNALS[kind])
        elif kind in FREEZES_S:
            victim.suspend()
            sleep(FREEZES_S[kind])
            with suppress(psutil.NoSuchProcess):
                victim.resume()
        elif kind in LINK_FAULTS:
            for proxy in self._harmed():
                proxy.fault = cast(LinkFault, kind)
            self._wait(LINK_FAULTS_S[kind], mission)
            for proxy in self._harmed():
                proxy.fault = ""
        elif self.folder is not None:
            switch = self.folder / SWITCH
            switch.touch()
            if kind != "disk_full":
                self._wait(MESSAGE_FAULTS_S if kind in MESSAGE_FAULTS else CLOCK_S, mission)
                switch.unlink()

    def _wait(self, time_s: float, mission: RunningMission) -> None:
        """Wait until the fault is over, but not beyond the end of the mission."""
        until = monotonic() + time_s
        longest = until + LONGER_S
        while (now := monotonic()) < until or (not self.has_harmed and now < longest):
            if mission.launcher.poll() is not None:
                return
            sleep(LOOK_S)

    def _harmed(self) -> list[LinkProxy]:
        """The links of the role; an agent has two."""
        role = self.cell.role
        return list(self._proxies.values()) if role == "agent" else [self._proxies[role]]


@contextmanager
def injector(cell: Cell, folder: Path, seed: int) -> Iterator[Injector]:
    """What brings the fault of a cell; `folder` is an empty one with mode 0700 and a short path."""
    if cell.kind in SIGNALS or cell.kind in FREEZES_S:
        yield Injector(cell, None, {})
        return
    (folder / CELL_FILE).write_text(json.dumps({"kind": cell.kind, "role": cell.role}))
    with ExitStack() as stack:
        proxies: dict[FaultRole, LinkProxy] = {}
        if cell.kind in LINK_FAULTS:
            for role in ("planner", "sim"):
                target = target_path(folder, role)
                draw = np.random.default_rng([seed, crc32(f"{cell.name} {role}".encode())])
                proxy = LinkProxy(proxy_path(folder, role), target.readlink, draw)
                stack.callback(proxy.close)
                proxies[role] = proxy
        yield Injector(cell, folder, proxies)
