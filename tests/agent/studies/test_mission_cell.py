from hashlib import sha256
from pathlib import Path
from typing import Any

import msgspec
import pytest

from agent_proc.pushing.solvable import solvable_by
from agent_proc.studies import mission_cell
from agent_proc.studies.mission_cell import MISSION, MissionCell, drawn, first_plan, resolve
from agent_proc.task.file import load_task
from legpush import in_process
from legpush.errors import ConfigError, PolicyError
from legpush.scenarios.random_room import RandomRoom
from legpush.scenarios.random_scenario import random_scenario
from legpush.scene.scenario import Scenario
from legpush.study.cells import columns_of

SMALL = RandomRoom(size_m=(6.0, 6.0), obstacles=2, mass_kg=0.5)


def test_a_cell_is_the_mission_in_one_process_with_equal_bits() -> None:
    cell = MissionCell(scenario="push", seed=1, policy="scripted", changes={"mission.max_push_cycles": 3})
    columns = columns_of(MISSION, resolve(cell, ()))
    run = in_process.run("push", seed=1, policy="scripted", changes={"mission.max_push_cycles": 3})
    assert columns["state_crc"] == run.state_crc
    assert (columns["reason"], columns["n_push_cycles"], columns["n_faces"]) == ("max_push_cycles", 3, 1)
    assert set(columns) == {column.name for column in MISSION.columns}
    assert columns["drawn_scenario"] == ""
    assert columns["n_unsolvable"] is None


def test_a_mission_that_ends_with_a_motion_that_is_refused_has_a_row() -> None:
    cell = MissionCell(scenario="push", policy="scripted", changes={"robot.pushing.reach_margin_deg": 30.0})
    columns = columns_of(MISSION, resolve(cell, ()))
    assert (columns["success"], columns["reason"]) == (False, "motion_refused")


def test_a_random_room_is_drawn_from_the_seed_as_the_command_draws_it_and_changed_after_that() -> None:
    resolved = resolve(MissionCell(seed=1, random_room=SMALL, changes={"mission.handover_distance_m": 2.0}), ())
    scenario, n_unsolvable = drawn(resolved)
    by_hand = random_scenario(SMALL, 1, solvable_by(first_plan, 1))
    assert scenario.room == by_hand.room
    assert (scenario.box.mass_kg, scenario.mission.handover_distance_m) == (0.5, 2.0)
    assert n_unsolvable >= 0
    assert resolved.scenario is None


def test_cells_with_the_same_room_draw_it_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []

    def counting(*of_room: Any) -> Scenario:
        asked.append(of_room[1])
        return random_scenario(*of_room)

    monkeypatch.setattr(mission_cell, "random_scenario", counting)
    rooms = [
        drawn(resolve(MissionCell(seed=seed, random_room=SMALL, changes={"realism.profile": profile}), ()))[0]
        for profile in ("ideal", "real")
        for seed in (70_001, 70_002)
    ]

    assert asked == [70_001, 70_002]
    assert rooms[0].room == rooms[2].room != rooms[1].room == rooms[3].room
    assert [room.realism.profile for room in rooms] == ["ideal", "ideal", "real", "real"]


def test_a_resolved_cell_comes_back_from_plain_values() -> None:
    for cell in (MissionCell(scenario="default", planner="rrt_star"), MissionCell(random_room=SMALL)):
        resolved = resolve(cell, ())
        assert msgspec.convert(msgspec.to_builtins(resolved), MISSION.resolved) == resolved


def test_a_scenario_and_a_random_room_do_not_go_together() -> None:
    with pytest.raises(ConfigError, match="Expected either a scenario or a random room, got both: push"):
        resolve(MissionCell(scenario="push", random_room=SMALL), ())


def test_a_push_map_is_known_by_its_hash(tmp_path: Path) -> None:
    (tmp_path / "map.json").write_text("{}")
    cell = MissionCell(scenario="push", policy="scripted", push_map=str(tmp_path / "map.json"))
    resolved = resolve(cell, ())
    assert resolved.push_map_sha256 == sha256(b"{}").hexdigest()
    (tmp_path / "map.json").write_text("[]")
    with pytest.raises(ConfigError, match=r"Expected the push map .* of the study, got another one"):
        MISSION.run(resolved)
    with pytest.raises(ConfigError, match="expected a push map"):
        resolve(MissionCell(push_map=str(tmp_path / "none.json")), ())


def test_policies_that_run_code_are_refused() -> None:
    with pytest.raises(PolicyError, match="runs code"):
        resolve(MissionCell(policy="evil:policy"), ())


def test_a_room_has_the_fields_of_a_random_room_with_its_defaults_and_no_others() -> None:
    room = msgspec.convert({"random_room": {"obstacles": 3}}, MissionCell).random_room
    assert msgspec.to_builtins(room) == msgspec.to_builtins(RandomRoom(obstacles=3))
    assert resolve(MissionCell(random_room=room), ()).random_room == RandomRoom(obstacles=3)
    with pytest.raises(msgspec.ValidationError, match="unknown field `obstacle`"):
        msgspec.convert({"random_room": {"obstacle": 3}}, MissionCell)


def test_a_rival_that_sees_nothing_may_choose_the_pushes() -> None:
    cell = MissionCell(scenario="push", seed=1, policy="alternate", changes={"mission.max_push_cycles": 2})
    resolved = resolve(cell, ())
    columns = columns_of(MISSION, resolved)
    assert (columns["reason"], columns["n_push_cycles"]) == ("max_push_cycles", 2)
    assert msgspec.convert(msgspec.to_builtins(resolved), MISSION.resolved) == resolved
    assert (resolved.policy_sha256, resolved.task) == ("", load_task("push-l4"))


def test_a_cell_of_a_policy_is_the_one_that_it_was_before_there_were_rivals() -> None:
    assert "task" not in msgspec.to_builtins(resolve(MissionCell(scenario="push"), ()))
