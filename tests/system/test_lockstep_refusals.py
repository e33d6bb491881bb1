"""Rubbish on every key of live services: refused, counted by cause, and the lockstep goes on as if nothing had been."""

import json
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import msgpack
import pytest
import zenoh

from legpush.bus import keys
from legpush.bus.endpoints import in_directory
from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION
from tests.legpush.examples import MESSAGES, QUERY
from tests.legpush.fakes import RUN, Agent, agent, crc_after, eventually, fake_plan, mission, planner, sim

MISSION = mission(8)
CAUSES = ("malformed", "oversize", "not_finite", "version", "foreign_run", "sender")
TARGETS = {
    "action_push": (keys.action(RUN, "main"), "sim"),
    "plan_request": (keys.plan_request(RUN, "main"), "planner"),
    "observation": (keys.observation(RUN, "main"), "agent"),
    "plan_result": (keys.plan_result(RUN, "main"), "agent"),
    "status": (keys.status(RUN, "sim", "main"), "agent"),
}
"""For each kind of message its key and the process that listens there."""


def spoilt(name: str) -> Iterator[tuple[str, bytes]]:
    """The example message made wrong in every way, each with the cause that it is refused for."""

    def plain() -> Any:
        return msgpack.unpackb(codec.encode(MESSAGES[name]))

    yield "malformed", b""
    yield "malformed", b"\xc1\xff\x00"
    yield "malformed", b"\x91" * 10_000
    yield "malformed", msgpack.packb([1, 2, 3])
    yield "malformed", msgpack.packb({**plain(), "surprise": 1})
    yield "malformed", codec.encode(MESSAGES[name])[:-1]
    yield "oversize", bytes(codec.MAX_MESSAGE_BYTES + 1)
    yield "not_finite", msgpack.packb({**plain(), "surprise": float("nan")})
    for cause, field, value in (
        ("version", "protocol", PROTOCOL_VERSION + 1),
        ("foreign_run", "run", "another"),
        ("sender", "role", "launcher"),
    ):
        message = plain()
        message["header"][field] = value
        yield cause, msgpack.packb(message)


@pytest.fixture
def attacker(tmp_path: Path) -> Iterator[zenoh.Session]:
    """Zenoh as anybody could use it, connected to all that listens."""
    config = zenoh.Config()
    settings: dict[str, Any] = {
        "mode": "peer",
        "listen/endpoints": [],
        "connect/endpoints": list(in_directory(tmp_path, "launcher").connect),
        "connect/retry": {"period_init_ms": 20, "period_max_ms": 20},
        "connect/timeout_ms": -1,
        "connect/exit_on_failure": False,
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "open/return_conditions/connect_scouted": False,
    }
    for path, value in settings.items():
        config.insert_json5(path, json.dumps(value))
    with zenoh.open(config) as session:
        yield session


def reach(session: zenoh.Session, key: str) -> zenoh.Publisher:
    """A publisher that somebody listens to."""
    publisher = session.declare_publisher(key, congestion_control=zenoh.CongestionControl.BLOCK)
    assert eventually(lambda: publisher.matching_status.matching)  # type: ignore[attr-defined]
    return publisher


@pytest.mark.parametrize("name", TARGETS)
def test_rubbish_is_refused_and_counted_and_the_mission_goes_on(
    tmp_path: Path, attacker: zenoh.Session, name: str
) -> None:
    key, target = TARGETS[name]
    with ExitStack() as stack:
        buses = {"sim": stack.enter_context(sim(tmp_path)), "planner": stack.enter_context(planner(tmp_path))}
        asking: Agent = stack.enter_context(agent(tmp_path))
        buses["agent"] = asking.bus
        asking.do(MISSION[:4])

        publisher = reach(attacker, key)
        expected = dict.fromkeys(CAUSES, 0)
        for cause, payload in spoilt(name):
            publisher.put(payload)
            expected[cause] += 1
        assert min(expected.values()) > 0
        tally = buses[target].tally
        assert eventually(lambda: {cause: tally[cause] for cause in CAUSES} == expected), tally.as_dict()

        assert asking.do(MISSION[4:]) == crc_after(MISSION)
        assert asking.planner.plan(QUERY) == fake_plan(QUERY)


def test_valid_answers_to_somebody_else_or_from_nobody_are_dropped(tmp_path: Path, attacker: zenoh.Session) -> None:
    with sim(tmp_path), planner(tmp_path), agent(tmp_path) as asking:
        asking.do(MISSION[:4])
        for name in ("observation", "plan_result"):
            reach(attacker, TARGETS[name][0]).put(codec.encode(MESSAGES[name]))
        assert asking.do(MISSION[4:]) == crc_after(MISSION)
        assert asking.planner.plan(QUERY) == fake_plan(QUERY)
        assert eventually(lambda: asking.planner.plan(QUERY) is not None and asking.bus.tally["late"] == 2)


def test_an_action_of_a_stranger_in_the_middle_of_an_episode_is_not_carried_out(
    tmp_path: Path, attacker: zenoh.Session
) -> None:
    with sim(tmp_path) as serving, agent(tmp_path) as asking:
        asking.do(MISSION[:4])
        reach(attacker, keys.action(RUN, "main")).put(codec.encode(MESSAGES["action_push"]))
        assert eventually(lambda: serving.tally["no_token"] == 1)
        assert asking.do(MISSION[4:]) == crc_after(MISSION)
