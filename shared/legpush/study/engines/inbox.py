"""The jobs that heads ask a worker for, while it does another one and while it does none."""

from typing import Final

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.messages.jobs import JobRequest

MOST_HEADS: Final = 256
"""Of how many heads a job waits, and the last one is remembered."""


class Inbox:
    """The jobs that wait for a worker, in the order in which their heads first asked.

    A head waits for one job at a time, and asks for it again and again: its newest job takes the place of the others.
    """

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._requests = bus.subscribe(channels.job_requests(bus.run, bus.name))
        self._waiting: dict[str, JobRequest] = {}
        """By incarnation of the head."""

    def next(self, timeout_s: float) -> JobRequest | None:
        """Return the job that waits longest, or None if none comes within `timeout_s`."""
        if not self._waiting and (request := self._requests.next(timeout_s)) is not None:
            self._keep(request)
        self._take_in()
        while self._waiting:
            request = self._waiting.pop(next(iter(self._waiting)))
            if self._is_there(request):
                return request
        return None

    def is_given_up(self, running: JobRequest) -> bool:
        """Return whether the head of a job that runs, or has just ended, waits for a later one by now.

        Copies of it that have come are dropped.
        """
        self._take_in()
        head = running.header.incarnation
        later = self._waiting.get(head)
        if later is not None and later.number <= running.number:
            del self._waiting[head]
            later = None
        return later is not None

    def _take_in(self) -> None:
        for request in self._requests.drain():
            self._keep(request)

    def _keep(self, request: JobRequest) -> None:
        head = request.header.incarnation
        if not self._is_there(request):
            return
        if head not in self._waiting and len(self._waiting) >= MOST_HEADS:
            self._bus.tally.add("overflow", f"expected jobs of at most {MOST_HEADS} heads at a time")
        elif head not in self._waiting or request.number > self._waiting[head].number:
            self._waiting[head] = request

    def _is_there(self, request: JobRequest) -> bool:
        """Return whether the head shows its token; one that does not is counted."""
        head = request.header
        if self._bus.liveliness.is_live("agent", head.name, head.incarnation):
            return True
        self._bus.tally.add("no_token", f"head {head.name} ({head.incarnation}) shows no liveliness token")
        return False
