"""Who is linked, who is a stranger and who stays silent is told once, and again after the link was gone."""

import logging
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from legpush.bus.secure.host_folder import Credentials
from legpush.bus.secure.link_watch import SILENT_S, LinkWatch

OWN = Credentials(
    folder=Path("/x"),
    role="agent",
    name="agent.laptop.1",
    ends=datetime(2027, 1, 1, tzinfo=UTC),
    names={
        "sim": ("sim.robot.1",),
        "agent": ("agent.laptop.1",),
        "recorder": ("recorder.laptop.1",),
        "router": ("router.hub.1",),
    },
)


class World:
    """What is linked and shown, and the watch that looks at it."""

    def __init__(self, caplog: pytest.LogCaptureFixture) -> None:
        self.linked: list[str] = []
        self.shown: set[str] = set()
        self._log = caplog
        self.watch = LinkWatch(OWN, (), lambda: self.linked, lambda: self.shown)

    def look(self, now: float) -> list[str]:
        """What is logged at this time."""
        self._log.clear()
        self.watch.look(now)
        return [record.getMessage() for record in self._log.records]


@pytest.fixture
def world(caplog: pytest.LogCaptureFixture) -> World:
    caplog.set_level(logging.INFO)
    return World(caplog)


def test_a_link_is_told_once(world: World) -> None:
    world.linked, world.shown = ["sim.robot.1"], {"sim"}
    assert world.look(0.0) == ["linked with sim.robot.1 as agent.laptop.1"]
    assert world.look(100.0) == []


def test_a_stranger_is_told_at_once(world: World) -> None:
    world.linked = ["sim.robot.9"]
    (said,) = world.look(0.0)
    assert said.startswith("linked with sim.robot.9, which is none of the names on this host: nothing comes from it")
    assert world.look(100.0) == []


def test_a_process_that_shows_nothing_is_told_once_and_again_after_it_was_gone(world: World) -> None:
    world.linked = ["sim.robot.1", "recorder.laptop.1"]
    for began in (0.0, 50.0):
        assert len(world.look(began)) == 2
        assert world.look(began + SILENT_S - 0.1) == []
        (said,) = world.look(began + SILENT_S)
        assert said.startswith("linked with sim.robot.1 for 3 s as agent.laptop.1, but it shows nothing in this run")
        assert world.look(began + SILENT_S + 9.0) == []
        world.linked = []
        assert world.look(began + 20.0) == []
        world.linked = ["sim.robot.1", "recorder.laptop.1"]


def test_a_process_that_has_shown_itself_is_not_told_about(world: World) -> None:
    """Also not while it ends: its token goes before its link."""
    world.linked, world.shown = ["sim.robot.1"], {"sim"}
    world.look(0.0)
    world.shown = set()
    assert world.look(SILENT_S) == []


def test_a_process_whose_certificate_expires_while_it_runs_says_so_once(
    world: World, caplog: pytest.LogCaptureFixture
) -> None:
    world.watch.look_at_clock(OWN.ends - timedelta(seconds=1))
    assert caplog.text == ""
    for _ in range(3):
        world.watch.look_at_clock(OWN.ends)
    (record,) = caplog.records
    assert record.getMessage().startswith(
        "the certificate agent.laptop.1 has expired, and its links are closed: `legpush"
    )


def test_a_router_behind_which_nobody_shows_is_told(world: World) -> None:
    world.linked = ["router.hub.1"]
    assert world.look(0.0) == ["linked with router.hub.1 as agent.laptop.1"]
    (said,) = world.look(SILENT_S)
    assert "shows nothing in this run: no other process is there yet, or the names on its host do not have" in said
    world.linked = []
    world.look(20.0)
    world.linked, world.shown = ["router.hub.1"], {"sim"}
    assert len(world.look(30.0)) == 1
    assert world.look(30.0 + SILENT_S) == []
