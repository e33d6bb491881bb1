"""Nothing comes in or goes out with a wrong certificate, whichever side connects, and the refused side is told why."""

import logging
import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from time import monotonic
from typing import Final

import pytest
import zenoh

from legpush.authority.carry_out import revoke
from legpush.authority.issue import Issuer, make_authority
from legpush.bus import keys
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints
from legpush.bus.secure.access_rules import EVERYBODY
from legpush.bus.secure.certificate_names import CertificateRole
from legpush.bus.secure.host_folder import read_credentials
from legpush.bus.session import ZenohSession
from legpush.errors import CredentialsError
from legpush.messages.common import Role
from tests.legpush.fakes import eventually
from tests.security.hosts import (
    EXPIRED,
    HOST,
    NOT_YET,
    copied,
    free_endpoint,
    give,
    issuer_of,
    let_in,
    made,
    raw_session,
    valid_between,
)
from tests.security.test_access import MESSAGES, RUN, Heard, included, put_all, show, tokens_of

ROLES: Final[tuple[CertificateRole, ...]] = ("planner", "sim", "agent")
TOLD_S: Final = 5.0
SETTLE_S: Final = 0.5

MakeHost = Callable[[Path, CertificateRole, Path], Path | None]
"""Makes the folder of a host with wrong credentials for a role, from a good one, in a new folder."""


def stranger(good: Path, role: CertificateRole, at: Path) -> Path:
    """Everything of another authority, under equal names."""
    return made(at / "authority")


def foreign(good: Path, role: CertificateRole, at: Path) -> Path:
    """A certificate of another authority in the folder of this one."""
    return give(copied(good, at / HOST), role, issuer_of(made(at / "authority")).issue(f"{role}.{HOST}.1", (), 1))


def expired(good: Path, role: CertificateRole, at: Path) -> Path:
    return give(copied(good, at / HOST), role, valid_between(good.parent, f"{role}.{HOST}.1", EXPIRED))


def not_yet_valid(good: Path, role: CertificateRole, at: Path) -> Path:
    return give(copied(good, at / HOST), role, valid_between(good.parent, f"{role}.{HOST}.1", NOT_YET))


def never_listed(good: Path, role: CertificateRole, at: Path) -> Path:
    """A certificate that the authority signed, with a name that is on the list of its own host alone."""
    name = f"{role}.elsewhere.1"
    return let_in(give(copied(good, at / HOST), role, issuer_of(good).issue(name, (), 1)), role, name)


def name_with_a_pattern(good: Path, role: CertificateRole, at: Path) -> Path:
    return give(copied(good, at / HOST), role, issuer_of(good).issue(f"{role}.*", (), 1))


def longer_name(good: Path, role: CertificateRole, at: Path) -> Path:
    """A name that begins as one that may take part."""
    name = f"{role}.{HOST}.10"
    return let_in(give(copied(good, at / HOST), role, issuer_of(good).issue(name, (), 1)), role, name)


def revoked(good: Path, role: CertificateRole, at: Path) -> Path:
    """A certificate that was on the list; the host itself still has the old list."""
    return let_in(copied(good.parent / "lost", at / HOST), role, f"{role}.lost.1")


def signed_by_itself(good: Path, role: CertificateRole, at: Path) -> Path:
    return give(copied(good, at / HOST), role, make_authority(f"{role}.{HOST}.1", 1))


def signed_by_a_process(good: Path, role: CertificateRole, at: Path) -> Path:
    """A certificate that another certificate of the authority signed, which is no authority."""
    pair = issuer_of(good).issue(f"{role}.{HOST}.1", (), 1)
    return give(copied(good, at / HOST), role, Issuer(pair).issue(f"{role}.{HOST}.1", (), 1))


def none(good: Path, role: CertificateRole, at: Path) -> None:
    """No certificate at all."""


def of_a_viewer(good: Path, role: CertificateRole, at: Path) -> Path:
    """The certificate of a viewer in the place of one of this role; the own list says that it is one."""
    host = give(copied(good, at / HOST), role, issuer_of(good).issue(f"viewer.{HOST}.1", (), 1))
    return let_in(host, role, f"viewer.{HOST}.1")


LINKED: Final[tuple[MakeHost, ...]] = (never_listed, longer_name, name_with_a_pattern, revoked, of_a_viewer)
"""The authority signed these, so TLS lets them in, and the access rules have to keep everything from them."""
REFUSED: Final[tuple[MakeHost, ...]] = (
    stranger,
    foreign,
    expired,
    not_yet_valid,
    signed_by_itself,
    signed_by_a_process,
    none,
)
"""TLS refuses these."""


@dataclass(frozen=True)
class Defended:
    """Two processes with good credentials: one listens, the other connects to a place where anybody may listen."""

    host: Path
    listens_at: str
    connects_to: str
    sessions: tuple[zenoh.Session, ...]
    heard: tuple[Heard, ...]


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a host; the host `lost` was revoked and has its old certificates."""
    folder = tmp_path_factory.mktemp("authority") / "authority"
    host = made(folder, HOST, "lost")
    revoke(folder, ["lost"], [])
    return host


@pytest.fixture(scope="module")
def defended(host: Path) -> Iterator[Defended]:
    listens_at, connects_to = free_endpoint(), free_endpoint()
    sides = {
        "sim": Endpoints(listen=(listens_at,), credentials=read_credentials(host, "sim")),
        "agent": Endpoints(connect=(connects_to,), credentials=read_credentials(host, "agent")),
    }
    opened = [ZenohSession(at, role) for role, at in sides.items()]
    sessions: tuple[zenoh.Session, ...] = tuple(one._session for one in opened)
    heard = tuple(map(Heard, sessions))
    kept = [show(session, "defended") for session in sessions]
    yield Defended(host, listens_at, connects_to, sessions, heard)
    assert kept
    for one in opened:
        one.close()


@pytest.mark.parametrize("role", ROLES)
@pytest.mark.parametrize("wrong", [*LINKED, *REFUSED], ids=lambda wrong: wrong.__name__)
def test_nothing_comes_in_or_goes_out(
    defended: Defended, wrong: MakeHost, role: CertificateRole, tmp_path: Path
) -> None:
    """The attacker checks and obeys nothing: it publishes, subscribes and shows everything."""
    bad = wrong(defended.host, role, tmp_path)
    for heard in defended.heard:
        heard.messages.clear()
        heard.tokens.clear()
    with ExitStack() as stack:
        # Without a certificate nothing can listen.
        listen = [defended.connects_to] if bad is not None else []
        session = stack.enter_context(raw_session(bad, role, listen=listen, connect=[defended.listens_at]))
        went, kept = Heard(session), show(session, "attacker")
        if wrong in LINKED:
            assert eventually(lambda: len(session.info.links()) == 2)
        until = monotonic() + SETTLE_S
        while monotonic() < until:
            for one in (session, *defended.sessions):
                put_all(one)
            Event().wait(0.1)
        assert len(session.info.links()) == (2 if wrong in LINKED else 0)
        may_pass = included((f"{keys.prefix('*')}/tap/*/*/taken",), MESSAGES) if wrong is of_a_viewer else set()
        may_show = {keys.liveliness(RUN, "recorder", "view-1", "attacker")} if wrong is of_a_viewer else set()
        may_go = included((f"{keys.prefix('*')}/tap/*/*/copies",), MESSAGES) if wrong is of_a_viewer else set()
        may_see = included((EVERYBODY,), tokens_of("defended")) if wrong is of_a_viewer else set()
        for heard in defended.heard:
            assert heard.messages <= may_pass
            assert heard.tokens & tokens_of("attacker") <= may_show
        assert went.messages <= may_go
        assert went.tokens & tokens_of("defended") <= may_see
        assert kept


def of_another_role(good: Path, role: CertificateRole, at: Path) -> Path:
    """The certificate of a viewer in the place of one of this role, as by a slip of the hand."""
    return give(copied(good, at / HOST), role, issuer_of(good).issue(f"viewer.{HOST}.1", (), 1))


SIGNED_ELSEWHERE: Final = "{role}.pem: expected a certificate of the authority in .*, got {role}.robot.1, which another"
SILENT: Final = r"linked with \w+.robot.1 for \d s as {name}, but it shows nothing in this run: .*do not have {name} "
TOLD: Final[dict[MakeHost, str]] = {
    stranger: r"got one that another authority signed .*; this process is {role}.robot.1 of /",
    foreign: SIGNED_ELSEWHERE,
    signed_by_itself: SIGNED_ELSEWHERE,
    signed_by_a_process: SIGNED_ELSEWHERE,
    expired: r"{role}.pem: expected .* that is valid, but {role}.robot.1 expired at .*`legpush secure renew`",
    not_yet_valid: r"but {role}.robot.1 begins at .*, and the clock of this machine says",
    name_with_a_pattern: r"{role}.pem: expected .* in access.json\), got {role}.\*, which is none of the names",
    of_another_role: r"{role}.pem: expected .*{role}.robot.1, .* access.json\), got viewer.robot.1, that of a viewer",
    never_listed: SILENT.replace("{name}", "{role}.elsewhere.1"),
    longer_name: SILENT.replace("{name}", "{role}.robot.10"),
    revoked: SILENT.replace("{name}", "{role}.lost.1"),
}


@pytest.mark.parametrize("role", ["sim", "agent"])
@pytest.mark.parametrize("wrong", TOLD, ids=lambda wrong: wrong.__name__)
def test_the_refused_side_is_told_why_and_under_which_name(
    defended: Defended, wrong: MakeHost, role: Role, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """An agent connects to what listens; a simulator is connected to, by an agent that has waited for it."""
    bad = wrong(defended.host, role, tmp_path)
    assert bad is not None
    expected, at = TOLD[wrong].replace("{role}", role), (defended.listens_at if role == "agent" else free_endpoint(),)
    if (wrong, role) == (stranger, "sim"):  # the agent is told, and the simulator learns nothing but a failed handshake
        expected = r"got one that another authority signed .*; this process is agent.robot.1"
    caplog.set_level(logging.WARNING)
    with ExitStack() as stack:
        if role == "sim":
            good = Endpoints(connect=at, credentials=read_credentials(defended.host, "agent"))
            stack.enter_context(Bus(RUN, "agent", "main", good)).announce()
        began_s = monotonic()
        try:
            credentials = read_credentials(bad, role)
            endpoints = Endpoints(connect=at, credentials=credentials) if role == "agent" else None
            endpoints = endpoints or Endpoints(listen=at, credentials=credentials)
            stack.enter_context(Bus(RUN, role, "main", endpoints))
            eventually(lambda: re.search(expected, caplog.text) is not None, TOLD_S)
            said = caplog.text
        except CredentialsError as error:
            said = str(error)
    assert monotonic() - began_s < TOLD_S
    assert re.search(expected, said), said


def test_a_link_is_closed_when_a_certificate_expires(host: Path, tmp_path: Path) -> None:
    short = give(
        copied(host, tmp_path / HOST), "agent", valid_between(host.parent, f"agent.{HOST}.1", (-1.0, 4.0 / 86400))
    )
    at = free_endpoint()
    with (
        closing(ZenohSession(Endpoints(listen=(at,), credentials=read_credentials(host, "sim")), "sim")) as session,
        raw_session(short, "agent", connect=[at]),
    ):
        assert eventually(lambda: session.linked() == (f"agent.{HOST}.1",))
        assert eventually(lambda: session.linked() == ())
        Event().wait(1.0)
        assert session.linked() == ()
