"""Publishes what a mission is doing, and which peer it waits for."""

import logging

from legpush.bus.status import StatusBeacon

log = logging.getLogger(__name__)


class MissionProgress:
    """Publishes progress through a status beacon, and logs what each phase begins with."""

    def __init__(self, beacon: StatusBeacon) -> None:
        self._beacon = beacon
        self._told: tuple[str, float | None, str] = ("starting", None, "")

    def tell(self, phase: str, fraction: float | None, detail: str) -> None:
        """Publish a phase, the share of it that is done if known, and a detail."""
        if phase != self._told[0]:
            log.info("%s: %s", phase, detail)
        self._told = (phase, fraction, detail)
        self._beacon.publish_status(phase, fraction, detail)

    def wait(self, peer: str) -> None:
        """Publish which peer the mission waits for; empty when it goes on."""
        phase, fraction, detail = self._told
        self._beacon.publish_status(phase, fraction, detail, waiting_for=peer)
