"""Missions whose processes are killed: they are started again, and the mission ends as if nothing had happened."""

from pathlib import Path
from typing import get_args

import pytest

from legpush.messages.common import Role
from tests.system.conftest import ThoroughMission
from tests.system.missions import Phase, report_of, running_mission

PHASES: tuple[Phase, ...] = get_args(Phase)


@pytest.mark.parametrize("role", ["planner", "sim", "agent"])
def test_a_process_killed_while_planning_walking_and_pushing_changes_nothing(
    role: Role, thorough_mission: ThoroughMission, tmp_path: Path
) -> None:
    out = tmp_path / "run"
    killed: list[int] = []
    with running_mission(out, *thorough_mission.flags) as mission:
        for phase in PHASES:
            mission.wait_for(phase)
            victim = mission.process(role, *killed)
            victim.kill()
            killed.append(victim.pid)
        output = mission.output()
    assert output.count(f"the {role} was killed by SIGKILL; starting it again") == len(PHASES) == 3
    report, expected = report_of(out), report_of(thorough_mission.out)
    times = {"wall_time_s", "real_time_factor", "command"}
    assert {key: report[key] for key in report.keys() - times} == {
        key: expected[key] for key in expected.keys() - times
    }
