"""A mission in one process is the mission of three, bit for bit."""

import json
from pathlib import Path

import pytest

import legpush
from legpush.scenarios.changes import override
from legpush.scenarios.file import dump_scenario, load_scenario
from tests.system.missions import do_mission

ROOM = Path(__file__).with_name("random_room.toml")
"""`legpush scenarios random tests/system/random_room.toml --seed 7`."""


@pytest.mark.parametrize(("scenario", "seed"), [("default", 3), ("push", 2), (str(ROOM), 1)])
def test_a_mission_in_one_process_ends_in_the_state_that_three_processes_end_in(
    scenario: str, seed: int, tmp_path: Path
) -> None:
    require_equal_ends(scenario, seed, tmp_path / "run")


def test_a_way_that_is_blocked_meanwhile_makes_no_difference(tmp_path: Path) -> None:
    near = override(load_scenario("blocked_way"), {"goal.pose.x_m": 8.0, "goal.pose.y_m": 3.0})
    file = tmp_path / "blocked_way.toml"
    file.write_text(dump_scenario(near))
    require_equal_ends(str(file), 0, tmp_path / "run")


def require_equal_ends(scenario: str, seed: int, out: Path) -> None:
    do_mission(out, scenario, "--seed", str(seed), "--no-picture")
    three = json.loads((out / "report.json").read_bytes())

    one = legpush.run(scenario, seed=seed)

    assert (one.state_crc, one.success) == (three["state_crc"], three["success"])
    differ = {name for name in three if name not in ("wall_time_s", "real_time_factor", "command")}
    plain = json.loads(json.dumps(legpush_report(one)))
    assert {name: plain[name] for name in differ} == {name: three[name] for name in differ}


def legpush_report(run: legpush.MissionRun) -> dict[str, object]:
    return {name: builtins(getattr(run.report, name)) for name in run.report.__struct_fields__}


def builtins(value: object) -> object:
    import msgspec

    return msgspec.to_builtins(value)
