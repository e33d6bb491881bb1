import pytest

from agent_proc.studies.plan_cell import PLAN, Path, PlanCell, resolve
from legpush.study.cells import columns_of

SECONDS = {"first_plan_s", "all_plans_s"}


@pytest.mark.parametrize("path", ["trunk", "box"])
def test_a_query_has_the_same_answer_again(path: Path) -> None:
    resolved = resolve(PlanCell(path=path, seed=2), ())
    first, again = (columns_of(PLAN, resolved) for _ in range(2))
    assert first["status"] == "exact"
    assert first["length_m"] > 1.0
    assert {name: value for name, value in first.items() if name not in SECONDS} == {
        name: value for name, value in again.items() if name not in SECONDS
    }
    assert {column.name for column in PLAN.columns if column.may_differ} == SECONDS
    assert list(first) == [column.name for column in PLAN.columns]


def test_the_last_of_several_plans_counts() -> None:
    changes = {"planning.anytime": {"n_improvements": 2, "improvement_iterations": 50}}
    columns = columns_of(PLAN, resolve(PlanCell(planner="rrt_star", changes=changes), ()))
    assert columns["n_plans"] >= 2
    assert columns["first_plan_s"] <= columns["all_plans_s"]
