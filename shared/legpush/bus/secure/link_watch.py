"""Tells, within seconds, why no messages come or go although a process is there.

Zenoh is silent about certificates that are refused and about access rules that deny everything.
"""

import logging
import threading
from collections.abc import Callable, Collection, Sequence
from datetime import UTC, datetime
from time import monotonic
from typing import Final

from legpush.bus.secure.certificate_names import OF_ROUTERS, CertificateRole
from legpush.bus.secure.host_folder import Credentials
from legpush.bus.secure.probe import Verdict, shake_hands
from legpush.errors import CredentialsError

LOOK_S: Final = 0.5
SILENT_S: Final = 3.0
"""A linked process that shows no token for this long is told about: its rules may know nothing of this certificate."""
SHOWN: Final[tuple[CertificateRole, ...]] = ("planner", "sim", "agent", "worker")
"""Roles that show a token as soon as they can work."""
OTHERWISE: Final = "it is still starting, belongs to another run"

log = logging.getLogger(__name__)


class LinkWatch:
    """Logs which certificates are linked, which handshakes fail, and which processes stay silent; a context manager."""

    def __init__(
        self,
        credentials: Credentials,
        connect: Sequence[str],
        linked: Callable[[], Sequence[str]],
        shown: Callable[[], Collection[str]],
    ) -> None:
        """`linked` returns the certificate names of all links, `shown` the roles that have shown a token."""
        self._credentials = credentials
        self._unreached = list(connect)
        self._linked = linked
        self._shown = shown
        self._seen: set[str] = set()
        self._since: dict[str, float] = {}
        self._told: set[str] = set()
        self._has_expired = False
        self._end = threading.Event()
        self._looking = threading.Thread(target=self._watch_links, name="links", daemon=True)
        self._shaking = threading.Thread(target=self._watch_handshakes, name="handshakes", daemon=True)

    def __enter__(self) -> "LinkWatch":
        self._looking.start()
        self._shaking.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End both; a handshake that hangs is not waited for."""
        self._end.set()
        self._looking.join()

    def _watch_handshakes(self) -> None:
        """Shake hands with each process that was not there at the start, once it is there."""
        while self._unreached and not self._end.wait(LOOK_S):
            for locator in tuple(self._unreached):
                verdict = self._shake_hands(locator)
                if verdict.reached:
                    self._unreached.remove(locator)
                if verdict.refusal is not None:
                    log.error("%s", verdict.refusal)
                if verdict.silence is not None:
                    self._tell_once(verdict.silence)

    def _shake_hands(self, locator: str) -> Verdict:
        """Shake hands; with files that do not fit just now, nobody is reached."""
        try:
            return shake_hands(locator, self._credentials)
        except CredentialsError as error:
            self._tell_once(str(error))
            return Verdict(reached=False)

    def _tell_once(self, text: str) -> None:
        """Log what goes on for a while, and is tried again, once."""
        if text not in self._told:
            self._told.add(text)
            log.warning("%s", text)

    def _watch_links(self) -> None:
        while not self._end.wait(LOOK_S):
            self.look(monotonic())
            self.look_at_clock(datetime.now(UTC))

    def look_at_clock(self, now: datetime) -> None:
        """Log, once, that the own certificate has expired: links close then, and no others come about."""
        if now >= self._credentials.ends and not self._has_expired:
            self._has_expired = True
            log.error(
                "the certificate %s has expired, and its links are closed: `legpush secure renew` makes another one, "
                "with which this process has to be started again",
                self._credentials.name,
            )

    def look(self, now: float) -> None:
        """Look at the links at the time `now`, in seconds, and log what is new."""
        linked = self._linked()
        self._seen.update(self._shown())
        for name in linked:
            role = self._credentials.role_of(name)
            if name not in self._since:
                self._since[name] = now
                self._tell_link(name, role)
            shows = bool(self._seen) if role == OF_ROUTERS else role in self._seen
            is_silent = role in (*SHOWN, OF_ROUTERS) and not shows and now - self._since[name] >= SILENT_S
            if is_silent and name not in self._told:
                self._told.add(name)
                log.warning(
                    "linked with %s for %.0f s as %s, but it shows nothing in this run: %s, or the names on its host "
                    "do not have %s (revoked, or an older access.json)",
                    name,
                    now - self._since[name],
                    self._credentials.name,
                    "no other process is there yet" if role == OF_ROUTERS else OTHERWISE,
                    self._credentials.name,
                )
        for gone in self._since.keys() - set(linked):
            del self._since[gone]
            self._told.discard(gone)

    def _tell_link(self, name: str, role: CertificateRole | None) -> None:
        if role is None:
            log.warning(
                "linked with %s, which is none of the names on this host: nothing comes from it or goes to it; this "
                "process is %s",
                name,
                self._credentials.name,
            )
        else:
            log.info("linked with %s as %s", name, self._credentials.name)
