"""A second recording beside the first one, such as a branch beside its run, at equal simulated times."""

from typing import Final

import numpy as np
import viser

from legpush.history.run_history import RunHistory
from legpush.history.timeline import TRUNK, Timeline
from sim_proc.scene_3d.scene import Scene
from sim_proc.view.source import PUMP_S, Source

ROOT: Final = "/beside"
"""Frame of the second scene."""
GAP_M: Final = 1.0
"""Between the two rooms."""


class Beside:
    """The longest episode of a recording, drawn in a room of its own."""

    def __init__(self, server: viser.ViserServer, source: Source) -> None:
        self.scene = Scene(server, ROOT)
        self.title = source.title
        self._source = source
        self._history = RunHistory()
        self._drawn: Timeline | None = None

    def pump(self) -> None:
        """Add messages, while there are any."""
        if self._source.is_reading:
            self._source.pump(self._history, PUMP_S)

    def show(self, first: Timeline, row: int, *, follow: bool) -> None:
        """Draw the moment at which the first recording has this row, or the last one before."""
        episodes = self._history.episodes.values()
        timeline = max(episodes, key=lambda each: float(each.tick[-1]), default=None)
        if timeline is None:
            return
        if timeline is not self._drawn:
            self.scene.begin(timeline, aside_m=first.scenario.room.size_m[0] + GAP_M)
            self._drawn = timeline
        mine = int(timeline.rows_at(np.array([first.tick[row]]))[0])
        middle_m = first.qpos[row, TRUNK][:2]
        self.scene.show(self._history, timeline, mine, follow=follow, centre_m=middle_m)
