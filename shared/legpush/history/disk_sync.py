"""Brings what was written to a file onto the disk once a second, so that no write has to wait for the disk."""

import os
from threading import Event, Thread
from typing import Final

SYNC_EVERY_S: Final = 1.0
"""Longest time until a write is on the disk, where it survives a power loss."""


class DiskSync:
    """A thread that syncs an open file after writes, and once more at the end."""

    def __init__(self, file: int, every_s: float = SYNC_EVERY_S) -> None:
        self._file = file
        self._every_s = every_s
        self._written = Event()
        self._over = Event()
        self._error: OSError | None = None
        self._thread = Thread(target=self._run, name="sync to disk", daemon=True)

    def start(self) -> None:
        """Begin to sync."""
        self._thread.start()

    def stop(self) -> None:
        """Sync for the last time; the file may be closed when this returns."""
        self._over.set()
        self._thread.join()

    def note_write(self) -> None:
        """Have the file synced within a second.

        Raises:
            OSError: Syncing an earlier write failed.
        """
        if self._error is not None:
            raise self._error
        self._written.set()

    def _run(self) -> None:
        is_over = False
        while not is_over:
            is_over = self._over.wait(self._every_s)
            if self._written.is_set():
                self._written.clear()
                try:
                    os.fdatasync(self._file)
                except OSError as error:
                    self._error = error
