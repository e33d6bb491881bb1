import shutil
from pathlib import Path

import pytest

from agent_proc.learning.plan_file import CONFIG_FILE
from agent_proc.policies.folder import policy_path
from agent_proc.studies.comparison.contestants import cards_of, chosen_on, find_contestants, task_source
from agent_proc.studies.seed_trainings import STUDY, study_text
from legpush.errors import ConfigError, PolicyError
from legpush.study.folder import STUDY_FILE


def training(folder: Path, policy: str = "variable") -> Path:
    """The folder of a training that is done."""
    for which in ("best", "last"):
        shutil.copytree(policy_path(policy), folder / which)
    (folder / CONFIG_FILE).write_text("{}")
    return folder


def trainings(folder: Path, *seeds: int) -> Path:
    (folder / STUDY).mkdir(parents=True)
    (folder / STUDY / STUDY_FILE).write_text(study_text({}, seeds))
    for seed in seeds:
        training(folder / f"seed-{seed}")
    return folder


def test_a_contestant_is_a_study_of_seeds_a_training_a_policy_folder_or_a_name_and_then_come_the_rivals(
    tmp_path: Path,
) -> None:
    several, one = trainings(tmp_path / "several", 3, 1), training(tmp_path / "one")
    runs = [str(several), str(one), str(one / "best"), "scripted"]
    found = find_contestants(runs, "last")

    assert [each.label for each in found] == ["several", "one", "one/best", "scripted", "zero", "random", "constant"]
    assert found[0].policies == (str(several / "seed-1" / "last"), str(several / "seed-3" / "last"))
    assert found[0].seeds == (1, 3)
    assert found[1].policies == (str(one / "last"),)
    assert [each.is_rival for each in found] == [False] * 4 + [True] * 3
    assert task_source(found) == found[0].policies[0]
    assert task_source(find_contestants(["scripted"], "best")) is None


def test_the_starts_by_which_policies_were_chosen_are_known(tmp_path: Path) -> None:
    cards = cards_of(find_contestants([str(training(tmp_path / "one"))], "best"))
    assert len(cards) == 1
    assert cards[0].check is not None
    assert chosen_on(cards) == {"the best policy of a training": set(cards[0].check.seeds)}


def test_what_cannot_take_part_is_refused(tmp_path: Path) -> None:
    one = training(tmp_path / "one")
    for runs, error, match in (
        (["zero"], ConfigError, "got zero, which is in every comparison"),
        (["scripted", "scripted"], ConfigError, "Expected each policy once, got scripted twice"),
        ([str(one), str(training(tmp_path / "x" / "one"))], ConfigError, "folders with different names, got one twice"),
        (["nobody"], PolicyError, "Expected a policy"),
    ):
        with pytest.raises(error, match=match):
            find_contestants(runs, "best")
    shutil.rmtree(one / "last")
    with pytest.raises(ConfigError, match=rf"expected a training that is done; legpush train --resume {one} goes on"):
        find_contestants([str(one)], "best")


def test_of_several_seeds_the_whole_training_is_resumed(tmp_path: Path) -> None:
    seeds = tmp_path / "seeds"
    (seeds / STUDY).mkdir(parents=True)
    (seeds / STUDY / STUDY_FILE).write_text(study_text({}, [1, 2]))
    with pytest.raises(ConfigError, match=rf"{seeds}/seed-1: expected .* --resume {seeds} goes on"):
        find_contestants([str(seeds)], "best")
