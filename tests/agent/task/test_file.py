"""Task files: the built-in ones are what their names say, and what is wrong is named with its file and place."""

from pathlib import Path

import msgspec
import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.learning.env import PushEnv
from agent_proc.task.file import load_task, read_task, scenario_of_task, task_names
from legpush.errors import ConfigError, ScenarioError
from legpush.scenarios.file import dump_scenario, load_scenario
from tests.agent.fake_world import FakeWorld, scenario_at_station

HEAD = 'entry = "fixed"\n[observation.body]\n[reward.fall]\nweight = -1.0\n[ending.tolerance]\n'


def write(folder: Path, text: str) -> str:
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_the_built_in_tasks_are_there() -> None:
    assert task_names() == (
        "paper-learns",
        "paper-observation",
        "paper-text",
        "push-l1",
        "push-l2",
        "push-l3",
        "push-l4",
        "release",
        "tuned",
        "wide",
    )


def test_the_least_change_that_learns_differs_from_the_paper_in_what_is_said_and_nothing_else() -> None:
    text, learns, tuned = (load_task(name) for name in ("paper-text", "paper-learns", "tuned"))

    assert (learns.reward, learns.max_steps, learns.fixed_depth_m) == (text.reward, text.max_steps, text.fixed_depth_m)
    assert (learns.observation, learns.mirrored) == (tuned.observation, tuned.mirrored)
    assert list(learns.ending) == [*text.ending, "past_goal"]
    assert {task.entry for task in (text, learns)} == {"fixed"}
    assert (learns.domain.box_xy_m, text.domain.box_xy_m) == (None, 0.0)


def test_the_observation_of_the_paper_kept_differs_from_the_paper_in_its_end_and_its_starts_alone() -> None:
    text, kept = load_task("paper-text"), load_task("paper-observation")

    assert list(kept.ending) == [*text.ending, "past_goal"]
    assert (kept.domain.box_xy_m, text.domain.box_xy_m) == (None, 0.0)
    assert replace(kept, description=text.description, ending=text.ending, domain=text.domain) == text


def test_the_release_has_the_actions_end_and_pay_of_the_published_code() -> None:
    release = load_task("release")

    assert (release.entry, release.action_form, release.mirrored) == ("fixed", "discrete", False)
    assert release.ending == {"release": {"term": "release", "corner_m": 0.1, "x_m": 0.05}}
    assert {name: table["weight"] for name, table in release.reward.items()} == {
        "position": -10.0,
        "near": 100.0,
        "both_near": 10_000.0,
        "ends_near": 100.0,
        "fall": -10_000.0,
    }
    assert all(release.observation[f"box_corner_{corner}"]["frozen"] for corner in (1, 2))
    assert (release.domain.box_xy_m, release.domain.box_yaw_deg) == (0.0, 0.0)


def test_the_published_code_ends_an_episode_near_the_goal_in_x_alone_and_pays_for_it() -> None:
    env = PushEnv(load_task("release", scenario_at_station()), FakeWorld())
    observation, _ = env.reset(seed=0)
    first = observation.copy()
    terminated, right = False, 0
    while not terminated:
        observation, reward, terminated, _, info = env.step(np.array([4, 4, right]))
        right = 1 - right
        assert observation in env.observation_space
        # The body and the forces are those of now, the corners of the box and its goal never change.
        np.testing.assert_array_equal(observation[7:], first[7:])
    assert info["ending"] == "missed"
    assert 0.05 < info["position_error_m"] < 0.1
    assert {name for name, term in info["reward_terms"].items() if term > 0.0} == {"ends_near"}
    assert 95.0 < reward < 100.0


@pytest.mark.parametrize("name", task_names())
def test_every_term_has_every_setting(name: str) -> None:
    task = load_task(name)

    assert all("scale" in table for table in task.observation.values())
    assert all("weight" in table for table in task.reward.values())
    assert task == read_task({**_plain(name), "scenario": load_scenario(scenario_of_task(name))}, "card")


def _plain(name: str) -> dict[str, object]:
    plain: dict[str, object] = msgspec.json.decode(msgspec.json.encode(load_task(name)))
    return plain


def test_a_file_may_be_short_and_names_its_scenario_from_its_own_folder(tmp_path: Path) -> None:
    (tmp_path / "room.toml").write_text(_push_with_mass(0.7))
    task = load_task(write(tmp_path, f'scenario = "room.toml"\ndescription = "mine"\n{HEAD}'))

    assert (task.scenario.box.mass_kg, task.description, task.mirrored) == (0.7, "mine", False)
    assert task.max_steps == 200


def _push_with_mass(mass_kg: float) -> str:
    push = load_scenario("push")
    return dump_scenario(replace(push, box=replace(push.box, mass_kg=mass_kg)))


def test_tolerances_of_the_goal_are_keys_of_the_task(tmp_path: Path) -> None:
    task = load_task(write(tmp_path, f"{HEAD}[tolerance]\nposition_m = 0.01\n"))
    goal = task.scenario.goal

    assert (goal.position_tolerance_m, goal.angle_tolerance_deg) == (0.01, 3.0)


def test_changes_replace_what_the_file_says() -> None:
    heavy = replace(load_scenario("push"), name="heavy")
    task = load_task("paper-text", heavy, entry="variable", domain={"mass_kg": [1.0, 2.0], "box_xy_m": 0.1})

    assert (task.entry, task.scenario.name, task.domain.mass_kg) == ("variable", "heavy", (1.0, 2.0))
    assert (task.domain.box_xy_m, task.domain.box_yaw_deg) == (0.1, 0.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("entry = ", r"expected a task in TOML"),
        ('entry = "deep"', r"at `entry`: expected one of fixed, variable, got 'deep'"),
        ("max_step = 3", r"at `max_step`: unknown field \(did you mean `max_steps`\?\).*tolerance"),
        ("[reward.fall]", r"at `observation`: expected a value, got nothing"),
        (f"{HEAD}[domain]\nmass = 3", r"at `domain.mass`: unknown field \(did you mean `mass_kg`\?\)"),
        (f"{HEAD}[tolerance]\nposition = 3", r"at `tolerance.position`: unknown field"),
        (f"{HEAD}[ending.late]", r"at `ending.late`: expected one of the terms tolerance, past_goal"),
        (f"scenario = 3\n{HEAD}", r"at `scenario`: expected the name or the path of a scenario, got 3"),
        (f"max_steps = 99999999\n{HEAD}", r"at `max_steps`: expected a whole number from 1 to 10000"),
    ],
)
def test_a_wrong_file_is_refused_with_its_place(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message) as refused:
        load_task(write(tmp_path, text))
    assert "mine.toml" in str(refused.value)


def test_what_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"mine\.toml: expected a task in TOML \(.*No such file"):
        load_task(str(tmp_path / "mine.toml"))
    with pytest.raises(ConfigError, match=r"the name of a task \(paper-learns, .*\) or the path .* got 'papier'"):
        load_task("papier")
    with pytest.raises(ScenarioError, match="nowhere"):
        load_task(write(tmp_path, f'scenario = "nowhere"\n{HEAD}'))
    with pytest.raises(ConfigError, match="card: expected the table of a task, got 3"):
        read_task(3, "card")
