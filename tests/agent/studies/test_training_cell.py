import base64
import io
import zipfile
from pathlib import Path

import msgspec
import pytest
from msgspec.structs import replace
from safetensors.numpy import load

from agent_proc.policies.folder import policy_path, read_card, read_policy
from agent_proc.studies.training_cell import TRAINING, resolve, run
from agent_proc.studies.training_run import of_last, pack
from agent_proc.studies.training_settings import TrainingCell
from agent_proc.task.file import load_task
from legpush.errors import ConfigError, PolicyError
from legpush.scenarios.file import load_scenario
from legpush.study.cells import columns_of


def test_a_training_returns_its_best_policy(tmp_path: Path) -> None:
    resolved = resolve(TrainingCell(steps=16, n_simulators=2, changes={"mission.max_push_cycles": 4}), ())
    profile = {**resolved.profile, "evaluation_episodes": 1, "evaluate_every": 16}
    profile["settings"] = {**profile["settings"], "n_steps": 8, "batch_size": 8}
    small = msgspec.structs.replace(resolved, profile=profile)
    columns = columns_of(TRAINING, small)
    assert columns["best_step"] <= columns["steps_done"] == 16
    assert list(columns) == [column.name for column in TRAINING.columns]
    assert columns["n_evaluated"] == 1
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(columns["policy_zip"]))) as archive:
        archive.extractall(tmp_path / "policy")
    card = read_policy(tmp_path / "policy").card
    assert (card.steps, card.seed, card.n_simulators) == (columns["best_step"], 0, 2)


def test_a_training_in_the_map_begins_with_a_policy() -> None:
    cell = TrainingCell(steps=16, world="map", init="variable", changes={"mission.max_push_cycles": 4})
    resolved = resolve(cell, ())
    profile = {**resolved.profile, "evaluation_episodes": 1, "evaluate_every": 16}
    profile["settings"] = {**profile["settings"], "n_steps": 8, "batch_size": 8, "learning_rate": 1e-9}
    small = msgspec.structs.replace(resolved, profile=profile)

    columns = columns_of(TRAINING, small)
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(columns["policy_zip"]))) as archive:
        content = archive.read("policy.safetensors")
    weight = load(content)["layers.0.weight"]
    assert weight == pytest.approx(read_policy(policy_path("variable")).layers[0].weight, abs=1e-5)
    with pytest.raises(PolicyError, match="Expected the policy variable with the SHA-256 other"):
        columns_of(TRAINING, msgspec.structs.replace(small, init_sha256="other"))
    with pytest.raises(ConfigError, match="Expected a world among"):
        resolve(TrainingCell(world="magic"), ())


def test_a_resolved_cell_comes_back_from_plain_values() -> None:
    resolved = resolve(TrainingCell(profile="sac", mass_kg=(0.1, 0.5)), ())
    assert msgspec.convert(msgspec.to_builtins(resolved), TRAINING.resolved) == resolved


def test_the_episodes_and_the_last_evaluation_come_from_the_card() -> None:
    card = read_card(policy_path("variable"))
    assert card.check is not None
    columns = of_last(card)
    episodes = [values for name, values in columns.items() if name.startswith("episode_")]
    assert [len(values) for values in episodes] == [len(card.curve)] * 5
    assert columns["episode_step"] == [point.step for point in card.curve]
    assert columns["last_position_error_m"] == card.check.position_error_m
    assert columns["n_evaluated"] == len(card.check.seeds) > 1


def test_other_widths_replace_those_of_the_profile() -> None:
    usual, wide = (resolve(TrainingCell(hidden=hidden), ()).profile for hidden in (None, (128, 128)))
    assert wide["network"] == {**usual["network"], "hidden": (128, 128)}


def test_settings_of_the_profile_and_its_task_may_be_replaced() -> None:
    usual = resolve(TrainingCell(profile="paper-text"), ())
    other = resolve(
        TrainingCell(profile="paper-text", task="paper-learns", normalize_observation=True, n_steps=256, batch_size=64),
        (),
    )

    assert usual.profile["settings"]["n_steps"] == 2048
    assert other.profile["settings"] == {**usual.profile["settings"], "n_steps": 256, "batch_size": 64}
    assert (usual.profile["normalize_observation"], other.profile["normalize_observation"]) == (False, True)
    assert [list(each.task.ending) for each in (usual, other)] == [["tolerance"], ["tolerance", "past_goal"]]
    assert usual.task.entry == "fixed"


def test_a_task_may_be_put_together_of_parts_of_others() -> None:
    text, learns, release = (load_task(name) for name in ("paper-text", "paper-learns", "release"))
    cell = TrainingCell(
        profile="paper-text",
        observation="paper-learns",
        reward="release",
        ending="release",
        starts="paper-learns",
        mass_kg=(0.1, 0.2),
        final_ending="paper-learns",
    )
    resolved = resolve(cell, ())

    task = resolved.task
    assert (task.observation, task.mirrored) == (learns.observation, learns.mirrored)
    assert (task.reward, task.ending) == (release.reward, release.ending)
    assert task.domain == replace(learns.domain, mass_kg=(0.1, 0.2))
    assert (task.entry, task.action_form, task.scenario) == (text.entry, text.action_form, text.scenario)
    assert resolved.final_task == replace(task, ending=learns.ending)


def test_the_last_policy_may_be_judged_in_another_scenario_and_another_simulator() -> None:
    cell = TrainingCell(
        profile="tuned", task="push-l3", scenario="open", world="map_unknown", steps=256, final_episodes=2
    )
    here = resolve(cell, ())
    there = resolve(replace(cell, final_scenario="open_real", final_world="mujoco", final_starts="wide"), ())

    assert here.final_task == there.task == here.task
    wide = load_task("wide").domain
    assert there.final_task == replace(there.task, scenario=load_scenario("open_real"), domain=wide) != there.task
    assert (here.final_world, there.world, there.final_world) == ("map_unknown", "map_unknown", "mujoco")
    with pytest.raises(ConfigError, match=r"Expected a world among .* got 'magic'"):
        resolve(replace(cell, final_world="magic"), ())


def test_a_training_cannot_begin_with_a_policy_of_another_observation() -> None:
    with pytest.raises(PolicyError, match="variable: expected a policy with the observation of this training, got one"):
        resolve(TrainingCell(task="push-l3", scenario="open", world="map_unknown", init="variable"), ())


def test_the_other_simulator_is_used() -> None:
    cell = TrainingCell(world="map", steps=256, final_episodes=1, changes={"mission.max_push_cycles": 2})
    columns = {world: run(resolve(replace(cell, final_world=world), ())) for world in ("map", "map_mean")}

    assert columns["map"]["last_position_error_m"] == columns["map_mean"]["last_position_error_m"]
    assert columns["map"]["final_position_error_m"] != columns["map_mean"]["final_position_error_m"]


def test_parts_that_do_not_fit_one_another_are_refused() -> None:
    with pytest.raises(ConfigError, match="Expected entry `fixed` with action_form `discrete`"):
        resolve(TrainingCell(profile="release", entry="variable"), ())
    with pytest.raises(ConfigError, match="Expected the name of a task"):
        resolve(TrainingCell(reward="best"), ())


def test_a_setting_that_the_algorithm_has_not_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"profile sac: at `settings.n_steps`: unknown field"):
        resolve(TrainingCell(profile="sac", n_steps=64), ())


def test_an_unknown_profile_is_refused() -> None:
    with pytest.raises(ConfigError, match="Expected the name of a profile"):
        resolve(TrainingCell(profile="best"), ())


def test_files_are_packed_by_name(tmp_path: Path) -> None:
    (tmp_path / "b").write_text("2")
    (tmp_path / "a").write_text("1")
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(pack(tmp_path)))) as archive:
        assert archive.namelist() == ["a", "b"]
        assert archive.read("b") == b"2"
