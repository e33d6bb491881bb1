"""Every certificate against every key: in comes what its role says and out goes what it hears, and nothing else."""

from collections.abc import Iterable
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from threading import Event
from typing import Any, Final

import pytest
import zenoh
from hypothesis import given
from hypothesis import strategies as st

from legpush.bus import channels, keys
from legpush.bus.endpoints import Endpoints
from legpush.bus.secure.access_rules import EVERYBODY, RIGHTS, access_control
from legpush.bus.secure.certificate_names import PROCESS_ROLES, CertificateRole
from legpush.bus.secure.host_folder import ACCESS_FILE, read_access, read_credentials
from legpush.bus.session import ZenohSession
from legpush.messages.common import Role
from tests.legpush.fakes import eventually
from tests.security.hosts import copied, free_endpoint, give, issuer_of, made, raw_session

RUN: Final = "r1"
BUS_ROLES: Final[tuple[Role, ...]] = ("planner", "sim", "agent", "worker", "launcher", "recorder")
MESSAGES: Final = (
    *(keys.plan_request(RUN, "main"), keys.plan_cancel(RUN, "main"), keys.plan_result(RUN, "main")),
    *(keys.action(RUN, "main"), keys.observation(RUN, "main"), keys.reward(RUN, "main")),
    *(keys.bundled_actions(RUN, "main"), keys.bundled_answers(RUN, "main")),
    *(keys.job_request(RUN, "main"), keys.job_result(RUN, "main")),
    *(make(RUN, role, "main") for role in BUS_ROLES for make in (keys.status, keys.copies, keys.taken)),
    *("legpush/v0/r1/sim/main/action", "elsewhere"),
)
"""Every kind of message, one of another version, and one of something else."""
SETTLE_S: Final = 0.3
"""What may not pass would have passed after this long."""
EVERYTHING: Final = "**"


def tokens_of(sender: str) -> set[str]:
    """Tokens of every role, and one of something else, that this sender shows."""
    names = [*((role, "main") for role in BUS_ROLES), ("recorder", "view-1")]
    return {*(keys.liveliness(RUN, role, name, sender) for role, name in names), f"elsewhere/{sender}"}


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.mktemp("authority") / "authority")


def rules(host: Path, open_flow: str | None) -> dict[str, Any]:
    """The access rules of this host, with everything allowed in one direction."""
    access = access_control(read_access(host / ACCESS_FILE).names)
    if open_flow is not None:
        every = ["put", "declare_subscriber", "liveliness_token", "declare_liveliness_subscriber", "liveliness_query"]
        allowed = {
            "id": "all",
            "permission": "allow",
            "flows": [open_flow],
            "messages": every,
            "key_exprs": [EVERYTHING],
        }
        access["rules"].append(allowed)
        access["policies"].append({"subjects": list(PROCESS_ROLES), "rules": ["all"]})
    return access


class Heard:
    """What came to a session: messages under any key, and tokens of others."""

    def __init__(self, session: zenoh.Session) -> None:
        self.messages: set[str] = set()
        self.tokens: set[str] = set()
        self._from: dict[str, set[str]] = {}
        remote = zenoh.Locality.REMOTE
        self._kept: list[object] = [
            session.declare_subscriber(key, self._note, allowed_origin=remote) for key in (*MESSAGES, EVERYTHING)
        ]
        self._kept += [
            session.liveliness().declare_subscriber(key, self._see, history=True) for key in (EVERYBODY, EVERYTHING)
        ]

    def of(self, sender: str) -> set[str]:
        """Return the keys under which something came that a sender has signed with its name."""
        return self._from.get(sender, set())

    def _note(self, sample: zenoh.Sample) -> None:
        key = str(sample.key_expr)
        self.messages.add(key)
        self._from.setdefault(sample.payload.to_string(), set()).add(key)

    def _see(self, sample: zenoh.Sample) -> None:
        self.tokens.add(str(sample.key_expr))


def put_all(session: zenoh.Session) -> bool:
    """Publish under every key."""
    for key in MESSAGES:
        session.put(key, b"", congestion_control=zenoh.CongestionControl.BLOCK)
    return True


def included(patterns: tuple[str, ...], found: Iterable[str]) -> set[str]:
    """The keys that one of the patterns includes."""
    return {key for key in found if any(zenoh.KeyExpr(pattern).includes(key) for pattern in patterns)}


def show(session: zenoh.Session, sender: str) -> list[object]:
    """Show all tokens of this sender."""
    return [session.liveliness().declare_token(token) for token in tokens_of(sender)]


@pytest.mark.parametrize("open_flow", [None, "ingress", "egress"])
def test_each_certificate_says_and_hears_what_its_role_may_and_nothing_else(host: Path, open_flow: str | None) -> None:
    """The other sides have no rules of their own, and publish and subscribe to everything.

    With one direction opened, the other one alone has to keep out what may not pass it.
    """
    at = free_endpoint()
    with ExitStack() as stack:
        defended = stack.enter_context(raw_session(host, "sim", listen=[at], access=rules(host, open_flow)))
        others = {role: stack.enter_context(raw_session(host, role, connect=[at])) for role in PROCESS_ROLES}
        assert eventually(lambda: len(defended.info.links()) == len(others))
        came, went = Heard(defended), {role: Heard(session) for role, session in others.items()}
        kept = show(defended, "defended")
        for role, rights in RIGHTS.items():
            kept += show(others[role], role)
            said, shown = included(rights.says, MESSAGES), included((rights.shows,), tokens_of(role))
            came.messages.clear()
            assert eventually(partial(everything_came, others[role], came, said, shown)), role
            Event().wait(SETTLE_S)
            if open_flow != "ingress":
                assert came.messages == said, role
                assert came.tokens & tokens_of(role) == shown, role
        for role, rights in RIGHTS.items():
            heard = included(rights.hears, MESSAGES)
            seen = included((EVERYBODY,), tokens_of("defended"))
            assert eventually(partial(everything_came, defended, went[role], heard, seen)), role
        Event().wait(SETTLE_S)
        for role, rights in RIGHTS.items():
            if open_flow != "egress":
                assert went[role].messages == included(rights.hears, MESSAGES), role
                assert went[role].tokens & tokens_of("defended") == included((EVERYBODY,), tokens_of("defended"))
        assert kept


def everything_came(sender: zenoh.Session, heard: Heard, messages: set[str], tokens: set[str]) -> bool:
    """Publish everything, and return whether all of this has come."""
    return put_all(sender) and messages <= heard.messages and tokens <= heard.tokens


USES: Final[tuple[tuple[CertificateRole, str, CertificateRole, str], ...]] = (
    ("agent", channels.plan_requests(RUN, "main").key, "planner", channels.plan_requests(RUN, "*").key),
    ("agent", channels.plan_cancels(RUN, "main").key, "planner", channels.plan_cancels(RUN, "*").key),
    ("planner", channels.plan_results(RUN, "main").key, "agent", channels.plan_results(RUN, "main").key),
    ("agent", channels.actions(RUN, "main").key, "sim", channels.actions(RUN, "main").key),
    ("sim", channels.answers(RUN, "main").key, "agent", channels.answers(RUN, "main").key),
    ("planner", channels.statuses(RUN, "planner", "main").key, "agent", channels.statuses(RUN, "planner").key),
    ("sim", channels.statuses(RUN, "sim", "main").key, "agent", channels.statuses(RUN, "sim", "main").key),
    *(
        (role, channels.statuses(RUN, role, "main").key, "launcher", channels.statuses(RUN).key)
        for role in ("planner", "sim", "agent", "recorder")
    ),
    *(
        (role, channels.copies(RUN, role, "main").key, recorder, channels.copies(RUN).key)
        for role in ("planner", "sim", "agent", "launcher")
        for recorder in ("recorder", "viewer")
    ),
    *(
        (recorder, channels.taken(RUN, role, "main").key, role, channels.taken(RUN, role, "main").key)
        for role in ("planner", "sim", "agent", "launcher")
        for recorder in ("recorder", "viewer")
    ),
)
"""Who says what under which key, who hears it, and under which key: as the processes do it."""


def note(heard: set[tuple[int, str]], number: int, key: str, payload: bytes) -> None:
    """Note that something came under a key, in the subscription of this number."""
    heard.add((number, key))


def test_what_processes_say_to_each_other_passes_the_rules_of_both_sides(host: Path) -> None:
    at = {role: free_endpoint() for role in PROCESS_ROLES}
    with ExitStack() as stack:
        sessions: dict[CertificateRole, ZenohSession] = {}
        for role, own in at.items():
            others = tuple(at[peer] for peer in sessions)
            there = Endpoints(listen=(own,), connect=others, credentials=read_credentials(host, role))
            sessions[role] = stack.enter_context(closing(ZenohSession(there, role)))
        heard: set[tuple[int, str]] = set()
        kept: list[object] = []
        for number, (_, _, hearer, pattern) in enumerate(USES):
            kept.append(sessions[hearer].subscribe(pattern, partial(note, heard, number)))
        senders = [sessions[sender].publisher(key, "tap").send for sender, key, _, _ in USES]

        def all_heard() -> bool:
            for send in senders:
                send(b"")
            return {(number, key) for number, (_, key, _, _) in enumerate(USES)} <= heard

        assert eventually(all_heard), [use for n, use in enumerate(USES) if (n, use[1]) not in heard]
        assert kept


def test_nothing_passes_a_router_even_if_a_good_certificate_is_behind_it(host: Path, tmp_path: Path) -> None:
    """The rules see the certificate of the router, and none is on the list."""
    router = give(copied(host, tmp_path / "router"), "agent", issuer_of(host).issue("router.robot.1", (), 1))
    at, through = free_endpoint(), free_endpoint()
    sim = Endpoints(listen=(at,), credentials=read_credentials(host, "sim"))
    with (
        closing(ZenohSession(sim, "sim main")) as defended,
        raw_session(router, "agent", listen=[through], connect=[at], mode="router"),
        raw_session(host, "agent", connect=[through]) as agent,
    ):
        came, went = Heard(defended._session), Heard(agent)
        kept = [*show(defended._session, "defended"), *show(agent, "agent")]
        assert eventually(lambda: defended.linked() == ("router.robot.1",) and bool(agent.info.links()))
        for _ in range(5):
            put_all(agent)
            put_all(defended._session)
            Event().wait(0.1)
        assert kept
        assert came.messages == went.messages == set()
        assert not came.tokens & tokens_of("agent")
        assert not went.tokens & tokens_of("defended")


def test_the_admin_space_answers_nobody(host: Path) -> None:
    at = free_endpoint()
    with (
        closing(ZenohSession(Endpoints(listen=(at,), credentials=read_credentials(host, "sim")), "sim main")),
        raw_session(host, "agent", connect=[at]) as session,
    ):
        assert eventually(lambda: bool(session.info.links()))
        assert [
            reply for reply in session.get("@/**", timeout=1.0) if str(session.info.zid()) not in str(reply.ok)
        ] == []


NAMES: Final = st.lists(st.from_regex(r"[a-z]{1,9}\.[0-9]", fullmatch=True))


@given(st.dictionaries(st.sampled_from(PROCESS_ROLES), NAMES))
def test_no_subject_is_without_names_which_would_be_everybody(names: dict[CertificateRole, list[str]]) -> None:
    access = access_control(names)
    assert access["default_permission"] == "deny"
    assert [subject["cert_common_names"] for subject in access["subjects"]] == [n for n in map(names.get, RIGHTS) if n]
    assert {role for policy in access["policies"] for role in policy["subjects"]} == {r for r in names if names[r]}
