"""Through two routers: each certificate says and hears what its role may, and a wrong one gets nothing in or out."""

import logging
import re
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from threading import Event
from time import monotonic
from typing import Final

import pytest
import zenoh

from legpush.authority.carry_out import revoke
from legpush.bus import keys
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, Mode, by_router
from legpush.bus.secure.access_rules import EVERYBODY, RIGHTS
from legpush.bus.secure.certificate_names import PROCESS_ROLES, CertificateRole
from legpush.bus.secure.host_folder import read_credentials
from legpush.bus.session import ZenohSession
from legpush.errors import CredentialsError
from legpush.lockstep.sim_host import SimConfig, buses
from legpush.messages.common import PROTOCOL_VERSION
from tests.legpush.fakes import eventually
from tests.security.hosts import HOST, free_endpoint, made, raw_session
from tests.security.test_access import MESSAGES, RUN, Heard, included, put_all, show, tokens_of
from tests.security.test_wrong_credentials import (
    LINKED,
    REFUSED,
    SETTLE_S,
    TOLD,
    TOLD_S,
    MakeHost,
    of_a_viewer,
    revoked,
    stranger,
)

Routers = tuple[str, str]
VERSIONS: Final = "versions"
"""A run in which no other test shows a token."""


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a host with a router; the host `lost` was revoked and has its old certificates."""
    folder = tmp_path_factory.mktemp("authority") / "authority"
    host = made(folder, HOST, "lost", routers=(HOST,))
    revoke(folder, ["lost"], [])
    return host


@pytest.fixture(scope="module")
def routers(host: Path) -> Iterator[Routers]:
    """Where two routers listen; the second one is linked with the first."""
    first, second, credentials = free_endpoint(), free_endpoint(), read_credentials(host, "router")
    places = (
        Endpoints(listen=(first,), credentials=credentials, mode="router"),
        Endpoints(listen=(second,), connect=(first,), credentials=credentials, mode="router"),
    )
    with ExitStack() as stack:
        opened = [stack.enter_context(closing(ZenohSession(at, "router"))) for at in places]
        assert eventually(lambda: f"router.{HOST}.1" in opened[0].linked())
        yield first, second


def clients(stack: ExitStack, host: Path, at: str) -> dict[CertificateRole, zenoh.Session]:
    """A client of each role, without rules of its own."""
    return {role: stack.enter_context(raw_session(host, role, connect=[at], mode="client")) for role in PROCESS_ROLES}


def test_each_certificate_says_and_hears_what_its_role_may_and_nothing_else(host: Path, routers: Routers) -> None:
    """Those who say something are clients of one router, and those who hear it are clients of either."""
    with ExitStack() as stack:
        speakers = clients(stack, host, routers[0])
        near, far = clients(stack, host, routers[0]), clients(stack, host, routers[1])
        heard = {(place, role): Heard(one) for place, at in enumerate((near, far)) for role, one in at.items()}
        for role, rights in RIGHTS.items():
            for ear in heard.values():
                ear.messages.clear()
            kept = show(speakers[role], f"of-{role}")
            said = included(rights.says, MESSAGES)
            shown = included((rights.shows,), tokens_of(f"of-{role}"))
            may = {key: said & included(RIGHTS[key[1]].hears, MESSAGES) for key in heard}

            def all_came(
                role: CertificateRole = role,
                may: dict[tuple[int, CertificateRole], set[str]] = may,
                shown: set[str] = shown,
            ) -> bool:
                put_all(speakers[role])
                return all(may[key] <= ear.messages and shown <= ear.tokens for key, ear in heard.items())

            assert eventually(all_came), role
            Event().wait(SETTLE_S)
            for key, ear in heard.items():
                assert ear.messages == may[key], (role, key)
                assert ear.tokens & tokens_of(f"of-{role}") == shown, (role, key)
            assert kept


def test_a_process_that_calls_itself_a_router_passes_on_what_its_own_role_may_say_and_nothing_else(
    host: Path, routers: Routers
) -> None:
    through = free_endpoint()
    with ExitStack() as stack:
        stack.enter_context(raw_session(host, "agent", listen=[through], connect=[routers[0]], mode="router"))
        behind = stack.enter_context(raw_session(host, "sim", connect=[through], mode="client"))
        far = stack.enter_context(raw_session(host, "agent", connect=[routers[1]], mode="client"))
        came, kept = Heard(far), show(behind, "behind")
        said = included(RIGHTS["sim"].says, MESSAGES) & included(RIGHTS["agent"].hears, MESSAGES)
        with raw_session(host, "sim", connect=[routers[1]], mode="client") as good:
            assert eventually(lambda: put_all(good) and said <= came.messages)
        Event().wait(SETTLE_S)
        came.messages.clear()
        until = monotonic() + SETTLE_S
        while monotonic() < until:
            put_all(behind)
            Event().wait(0.1)
        assert not came.messages & included(RIGHTS["sim"].says, MESSAGES)
        assert not came.tokens & included((RIGHTS["sim"].shows,), tokens_of("behind"))
        assert kept


@dataclass(frozen=True)
class Good:
    """Clients of the second router, one of each role; what they hear, and what they show."""

    sessions: dict[CertificateRole, zenoh.Session]
    heard: dict[CertificateRole, Heard]


@pytest.fixture(scope="module")
def good(host: Path, routers: Routers) -> Iterator[Good]:
    with ExitStack() as stack:
        sessions = clients(stack, host, routers[1])
        heard = {role: Heard(session) for role, session in sessions.items()}
        kept = [show(session, "good") for session in sessions.values()]
        yield Good(sessions, heard)
        assert kept


MODES: Final = (
    *((wrong, mode) for wrong in LINKED for mode in ("client", "router")),
    *((one, "peer") for one in REFUSED),
)
"""A client is not opened without a link, and a peer tries on."""


@pytest.mark.parametrize(("wrong", "mode"), MODES, ids=lambda value: getattr(value, "__name__", value))
def test_nothing_comes_in_or_goes_out(
    host: Path, routers: Routers, good: Good, wrong: MakeHost, mode: Mode, tmp_path: Path
) -> None:
    """The attacker is linked with the first router, and all others with the second one."""
    bad = wrong(host, "sim", tmp_path)
    attacker = f"attacker-{mode}"
    with ExitStack() as stack:
        session = stack.enter_context(raw_session(bad, "sim", connect=[routers[0]], mode=mode))
        went, shows = Heard(session), show(session, attacker)
        if wrong in LINKED:
            assert eventually(lambda: len(session.info.links()) == 1)
        until = monotonic() + SETTLE_S
        while monotonic() < until:
            for number, one in enumerate((session, *good.sessions.values())):
                for key in MESSAGES:
                    one.put(key, attacker if number == 0 else "good")
            Event().wait(0.1)
        assert len(session.info.links()) == (wrong in LINKED)
        is_viewer = wrong is of_a_viewer
        said = included(RIGHTS["viewer"].says, MESSAGES) if is_viewer else set()
        shown = {keys.liveliness(RUN, "recorder", "view-1", attacker)} if is_viewer else set()
        for role, ear in good.heard.items():
            assert ear.of(attacker) <= said, role
            assert ear.tokens & tokens_of(attacker) <= shown, role
        assert went.messages <= (included(RIGHTS["viewer"].hears, MESSAGES) if is_viewer else set())
        assert went.tokens & tokens_of("good") <= (included((EVERYBODY,), tokens_of("good")) if is_viewer else set())
        assert shows


@pytest.mark.parametrize("wrong", TOLD, ids=lambda wrong: wrong.__name__)
def test_a_refused_client_is_told_why_and_under_which_name(
    host: Path, routers: Routers, wrong: MakeHost, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    bad = wrong(host, "agent", tmp_path)
    assert bad is not None
    expected = TOLD[wrong].replace("{role}", "agent")
    caplog.set_level(logging.WARNING)
    with ExitStack() as stack:
        began_s = monotonic()
        try:
            at = by_router(routers[:1], read_credentials(bad, "agent"))
            stack.enter_context(Bus(RUN, "agent", "main", at))
            eventually(lambda: re.search(expected, caplog.text) is not None, TOLD_S)
            said = caplog.text
        except CredentialsError as error:
            said = str(error)
    assert monotonic() - began_s < TOLD_S
    assert re.search(expected, said), said


def test_several_simulators_of_a_process_that_was_revoked_tell_it_once(
    host: Path, routers: Routers, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """All of them show a token, over one link."""
    caplog.set_level(logging.INFO)
    at = by_router(routers[:1], read_credentials(revoked(host, "sim", tmp_path), "sim"))
    with buses(SimConfig(run=RUN, name="host", simulators=3), at, Event()) as members:
        for bus in members:
            bus.announce()
        assert eventually(lambda: "but it shows nothing in this run" in caplog.text, TOLD_S)
        Event().wait(SETTLE_S)
    said = [record.getMessage() for record in caplog.records]
    for words in ("taking part as", "but it shows nothing in this run", f"linked with router.{HOST}.1 as sim.lost.1"):
        assert sum(words in each for each in said) == 1, words


def test_a_client_that_waits_is_told_as_soon_as_a_router_comes_that_refuses_it(host: Path, tmp_path: Path) -> None:
    """The certificates that its own host can tell are refused before (see `TOLD`)."""
    at, bad = free_endpoint(), stranger(host, "agent", tmp_path)
    assert bad is not None
    credentials = read_credentials(bad, "agent")
    with ExitStack() as stack:
        thread = stack.enter_context(ThreadPoolExecutor(1))
        session = thread.submit(ZenohSession, by_router((at,), credentials), "agent main")
        with pytest.raises(TimeoutError):
            session.result(timeout=1.0)
        router = Endpoints(listen=(at,), credentials=read_credentials(host, "router"), mode="router")
        stack.enter_context(closing(ZenohSession(router, "router")))
        with pytest.raises(CredentialsError, match=TOLD[stranger].replace("{role}", "agent")):
            session.result(timeout=TOLD_S)


@pytest.mark.parametrize("is_direct", [False, True])
def test_a_peer_of_another_version_is_named_over_tls(host: Path, routers: Routers, is_direct: bool) -> None:
    """Behind another router, and linked directly: its token comes through, whatever protocol it speaks."""
    credentials, other, at = read_credentials(host, "agent"), PROTOCOL_VERSION - 1, free_endpoint()
    direct = Endpoints(listen=(at,), credentials=credentials)
    with ExitStack() as stack:
        places = direct if is_direct else by_router(routers[:1], credentials)
        agent = stack.enter_context(Bus(VERSIONS, "agent", "main", places))
        beside = at if is_direct else routers[1]
        peer = stack.enter_context(raw_session(host, "sim", connect=[beside], mode="peer" if is_direct else "client"))
        assert eventually(lambda: bool(peer.info.links()))
        token = peer.liveliness().declare_token(f"legpush/v{other}/{VERSIONS}/live/sim/main/a")
        assert token
        words = f"speaks protocol {other}, expected {PROTOCOL_VERSION}"
        assert eventually(partial(_says, agent, words)), agent.liveliness.describe("sim", "main")
        assert agent.liveliness.live() == []


def _says(agent: Bus, words: str) -> bool:
    return words in agent.liveliness.describe("sim", "main")
