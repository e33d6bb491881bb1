import pytest

from agent_proc.evaluation.starts import (
    FIRST_CHECK_SEED,
    FIRST_FINAL_SEED,
    FIRST_SEARCH_SEED,
    require_held_out,
    starts_of,
)
from agent_proc.task.drawn import scenario_of_start
from agent_proc.task.file import load_task
from legpush.errors import ConfigError
from legpush.options.learning_tools import FIRST_HELD_OUT_SEED, FIRST_TUNING_SEED


def test_a_start_by_which_something_was_chosen_is_refused() -> None:
    used = {"the best policy of a training": range(10, 20)}
    require_held_out(range(10), used, "--first-seed")
    match = "Expected starts that nothing was chosen on for --first-seed, got 3, such as 17, by which the best policy"
    with pytest.raises(ConfigError, match=match):
        require_held_out(range(17, 30), used, "--first-seed")


def test_the_usual_starts_of_each_purpose_are_a_million_apart() -> None:
    firsts = [FIRST_CHECK_SEED, FIRST_FINAL_SEED, FIRST_TUNING_SEED, FIRST_SEARCH_SEED, FIRST_HELD_OUT_SEED]
    assert firsts == [1_000_000 * place for place in range(1, 6)]


def test_a_level_is_evaluated_on_what_its_starts_draw() -> None:
    task = load_task("push-l1")
    drawn = starts_of(task)
    assert drawn(task.scenario, 3) == scenario_of_start(task, 3) != drawn(task.scenario, 4)
    tuned = load_task("tuned")
    assert starts_of(tuned)(tuned.scenario, 3) is tuned.scenario
