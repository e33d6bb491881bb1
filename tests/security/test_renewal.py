"""After certificates are renewed or revoked, the right processes are still linked, and no others."""

from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from threading import Event
from typing import Final

import pytest

from legpush.authority.carry_out import renew, revoke
from legpush.bus import keys
from legpush.bus.endpoints import Endpoints
from legpush.bus.secure.host_folder import read_credentials
from legpush.bus.session import ZenohSession
from tests.legpush.fakes import eventually
from tests.security.hosts import copied, free_endpoint, made

ACTION: Final = keys.action("r1", "main")
OBSERVATION: Final = keys.observation("r1", "main")
SETTLE_S: Final = 0.5


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    """The folder of an authority with two hosts."""
    return made(tmp_path / "lab", "robot", "laptop").parent


class Link:
    """A simulator on one host, an agent on the other."""

    def __init__(self, sim: ZenohSession, agent: ZenohSession) -> None:
        self._heard: set[str] = set()
        self._kept = (
            sim.subscribe(ACTION, lambda key, _: self._heard.add(key)),
            agent.subscribe(OBSERVATION, lambda key, _: self._heard.add(key)),
        )
        self._send = (sim.publisher(OBSERVATION, "lockstep").send, agent.publisher(ACTION, "lockstep").send)

    def passes(self) -> bool:
        """Whether something comes in both directions, before long."""
        self._heard.clear()

        def came() -> bool:
            for send in self._send:
                send(b"")
            return self._heard == {ACTION, OBSERVATION}

        return eventually(came, 3.0)

    def passes_nothing(self) -> bool:
        """Whether nothing comes for a while, in no direction."""
        self._heard.clear()
        for _ in range(5):
            for send in self._send:
                send(b"")
            Event().wait(SETTLE_S / 5)
        return not self._heard


def opened(stack: ExitStack, host: Path, role: str, at: str) -> ZenohSession:
    """A session of the simulator or the agent of a host."""
    if role == "sim":
        endpoints = Endpoints(listen=(at,), credentials=read_credentials(host, "sim"))
    else:
        endpoints = Endpoints(connect=(at,), credentials=read_credentials(host, "agent"))
    return stack.enter_context(closing(ZenohSession(endpoints, role)))


@contextmanager
def linked(robot: Path, laptop: Path) -> Iterator[Link]:
    """A simulator with the folder of a robot and an agent with that of a laptop."""
    at = free_endpoint()
    with ExitStack() as stack:
        sim, agent = opened(stack, robot, "sim", at), opened(stack, laptop, "agent", at)
        assert eventually(lambda: bool(agent.linked()))
        yield Link(sim, agent)


def test_hosts_with_new_and_with_old_folders_talk_to_each_other(lab: Path, tmp_path: Path) -> None:
    old = {name: copied(lab / name, tmp_path / f"old-{name}") for name in ("robot", "laptop")}
    renew(lab, [], [], 90)
    for robot, laptop in (
        (lab / "robot", old["laptop"]),
        (old["robot"], lab / "laptop"),
        (lab / "robot", lab / "laptop"),
    ):
        with linked(robot, laptop) as link:
            assert link.passes(), (robot, laptop)


def test_a_revoked_certificate_works_until_the_other_side_is_started_with_the_new_list(
    lab: Path, tmp_path: Path
) -> None:
    lost = copied(lab / "laptop", tmp_path / "lost")
    with linked(lab / "robot", lost) as link:
        revoke(lab, ["laptop"], ["agent"])
        assert link.passes()
    with linked(lab / "robot", lost) as link:
        assert link.passes_nothing()


def test_a_host_that_got_certificates_again_after_a_revocation_takes_part_and_the_lost_ones_do_not(
    lab: Path, tmp_path: Path
) -> None:
    lost = copied(lab / "laptop", tmp_path / "lost")
    revoke(lab, ["laptop"], [])
    renew(lab, ["laptop"], [], 90)
    with linked(lab / "robot", lab / "laptop") as link:
        assert link.passes()
    with linked(lab / "robot", lost) as link:
        assert link.passes_nothing()
