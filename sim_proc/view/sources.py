"""Where the page's timelines come from: a recording, or a run that goes on."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from time import monotonic

from legpush.messages.tap import Origin
from legpush.recording.mcap_reader import Recorded, read_recording
from legpush.timelines import Timelines


class RecordedRun:
    """All messages of a recording."""

    is_live = False

    def __init__(self, files: Sequence[Path]) -> None:
        """`RecordingError` where it cannot be read."""
        recording = read_recording(files)
        self.title = f"Recording {', '.join(path.name for path in files)}"
        self._left: Iterator[Recorded] = iter(recording.messages)

    def pump(self, timelines: Timelines, budget_s: float) -> None:
        """Add messages for so long at most."""
        until = monotonic() + budget_s
        for message in self._left:
            timelines.take(message.topic, message.origin, message.copy)
            if monotonic() >= until:
                return

    def live(self) -> list[Origin] | None:
        """Nobody is there any more."""
        return None
