from msgspec.structs import replace

from agent_proc.map_world.simulator import mean_map_simulator
from agent_proc.policies.folder import policy_path, read_policy
from agent_proc.studies.final_evaluation import FINAL_COLUMNS, final_columns
from agent_proc.task.file import load_task
from legpush.lockstep.local import LocalWorld


def test_without_starts_nothing_is_evaluated() -> None:
    policy = read_policy(policy_path("fixed"))

    assert final_columns(policy, policy.card.task, [], 0) == {column.name: None for column in FINAL_COLUMNS}


def test_the_rules_of_the_evaluation_end_its_episodes() -> None:
    policy, world = read_policy(policy_path("fixed")), LocalWorld(mean_map_simulator())
    task = policy.card.task
    published = replace(task, ending=load_task("release").ending)

    own = final_columns(policy, task, [world], 3)
    other = final_columns(policy, published, [world], 3)

    assert [list(columns) for columns in (own, other)] == [[column.name for column in FINAL_COLUMNS]] * 2
    assert own["final_ended"] == other["final_ended"] == ["done"] * 3
    assert len(set(own["final_position_error_m"])) == 3
    assert max(own["final_position_error_m"]) < 0.03 < min(other["final_position_error_m"])
    assert own["nominal_position_error_m"] < 0.03
    assert own["nominal_n_cycles"] > other["nominal_n_cycles"]


def test_a_policy_that_gets_nowhere_fails_when_its_pushes_are_used_up() -> None:
    policy, world = read_policy(policy_path("fixed")), LocalWorld(mean_map_simulator())
    scenario = policy.card.task.scenario
    short = replace(policy.card.task, scenario=replace(scenario, mission=replace(scenario.mission, max_push_cycles=2)))

    columns = final_columns(policy, short, [world], 1)

    assert (columns["final_ended"], columns["final_success"]) == (["max_cycles"], [False])
    assert columns["final_n_cycles"] == [2]
