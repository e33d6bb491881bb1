"""Clients with access that mean harm: none of them ends a mission, and nothing that they ask for is carried out."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from threading import Event, Thread

import pytest

from legpush.bus.endpoints import in_directory
from legpush.bus.tally import Tally
from legpush.runs.live_runs import find_live_runs
from tests.legpush.examples import QUERY
from tests.legpush.fakes import RUN, FakeStepper, agent, crc_after, eventually, fake_plan, mission, planner, sim
from tests.system.conftest import RecordedMission
from tests.system.hostile import ATTACKS, Hostile, hostile
from tests.system.missions import report_of, running_mission

MISSION = mission(8)
APART = {"wall_time_s", "real_time_factor", "recording", "command"}
"""What the reports of equal missions do not share."""


def was_counted(tally: Tally, causes: set[str]) -> bool:
    """Whether a message was dropped or refused for one of these causes."""
    return any(tally[cause] for cause in causes)


@pytest.mark.parametrize("attack", ATTACKS, ids=lambda attack: attack.__name__)
def test_a_hostile_client_changes_nothing(tmp_path: Path, attack: Callable[[Hostile], None]) -> None:
    stepper = FakeStepper()
    with (
        sim(tmp_path, stepper) as serving,
        planner(tmp_path),
        agent(tmp_path) as asking,
        hostile(in_directory(tmp_path, "launcher").connect, RUN) as client,
    ):
        assert asking.planner.plan(QUERY) == fake_plan(QUERY)
        client.incarnation("sim")
        asking.do(MISSION[:4])
        assert eventually(lambda: client.heard()["step"] == 3)
        attack(client)
        tallies = {"sim": serving.tally, "agent": asking.bus.tally}
        assert asking.do(MISSION[4:]) == crc_after(MISSION)
        for victim, causes in ATTACKS[attack].items():
            assert eventually(partial(was_counted, tallies[victim], causes)), tallies[victim].as_dict()
        assert asking.planner.plan(QUERY) == fake_plan(QUERY)
    assert stepper.performed == MISSION


def test_all_of_them_together_change_nothing_in_a_mission(push_mission: RecordedMission, tmp_path: Path) -> None:
    out = tmp_path / "run"
    over, attacked = Event(), []
    with running_mission(out, "push") as running:
        running.wait_for("pushing")
        run = next(run for run in find_live_runs() if run.folder == str(out))
        with hostile(run.connect, run.run) as client:

            def attack() -> None:
                for each in ATTACKS:
                    if over.is_set():
                        return
                    each(client)
                    attacked.append(each)

            attacking = Thread(target=attack)
            attacking.start()
            output = running.output()
            over.set()
            attacking.join()
    report, expected = report_of(out), report_of(push_mission.out)
    assert {key: report[key] for key in report.keys() - APART} == {
        key: expected[key] for key in expected.keys() - APART
    }
    assert "starting it again" not in output
    assert len(attacked) == len(ATTACKS), attacked
