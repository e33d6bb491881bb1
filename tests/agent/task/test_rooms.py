"""Tasks whose episodes are missions in random rooms: what they may have, and where they are refused."""

from pathlib import Path

import msgspec
import pytest

from agent_proc.learning.env import PushEnv
from agent_proc.task.config import TaskConfig
from agent_proc.task.drawn import scenario_of_start
from agent_proc.task.file import load_task, read_task
from agent_proc.task.rooms import RoomFields, refuse_missions, room_of
from legpush.errors import ConfigError
from legpush.scenarios.random_room import RandomRoom
from tests.agent.fake_world import FakeWorld

LEVEL = load_task("push-l4")


def test_a_room_of_a_file_has_the_fields_of_a_random_room_and_no_others() -> None:
    assert room_of(msgspec.convert({"obstacles": 3}, RoomFields)) == RandomRoom(obstacles=3)
    with pytest.raises(msgspec.ValidationError, match="unknown field `obstacle`"):
        msgspec.convert({"obstacle": 3}, RoomFields)
    with pytest.raises(ConfigError, match="0 to 1000 obstacles, got -1"):
        load_task("push-l4", random_room={"obstacles": -1})


def test_the_task_of_other_episodes_is_written_as_before_there_were_rooms() -> None:
    assert "random_room" not in msgspec.to_builtins(load_task("tuned"))
    plain = msgspec.json.decode(msgspec.json.encode(LEVEL))
    assert plain["random_room"]["size_m"] == [8.0, 8.0]
    assert read_task(plain, "card") == LEVEL


def test_level_4_is_seen_and_pushed_as_the_default_task() -> None:
    tuned = load_task("tuned")

    def shared(task: TaskConfig) -> tuple[object, ...]:
        return task.observation, task.entry, task.action_form, task.mirrored, task.arrival_terms

    assert shared(LEVEL) == shared(tuned)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("changes_face = true\n", "Expected no `changes_face` with `random_room`"),
        ("[domain]\ndistance_m = [0.1, 1.0]\n", "Expected mass_kg and friction alone in the domain .* got distance_m"),
    ],
)
def test_what_the_mission_decides_and_the_room_has_is_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "task.toml").write_text(f"{text}\n[observation.box]\n[reward.fall]\n[ending]\n[random_room]\n")
    with pytest.raises(ConfigError, match=message):
        load_task(str(tmp_path / "task.toml"))


def test_where_an_episode_has_to_be_a_box_and_its_goal_it_is_refused() -> None:
    refuse_missions(load_task("tuned").random_room)
    with pytest.raises(ConfigError, match=r"got one with `random_room`.*PushL4-v2.*legpush study run .*level_l4.toml"):
        refuse_missions(LEVEL.random_room)
    with pytest.raises(ConfigError, match="whole missions"):
        scenario_of_start(LEVEL, 3)
    with pytest.raises(ConfigError, match="whole missions"):
        PushEnv(LEVEL, FakeWorld())
