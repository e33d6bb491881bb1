"""What a policy of a task observes."""

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.frames.push_view import PushView, push_view
from agent_proc.task.config import TaskConfig
from agent_proc.task.observed import n_observed, observation_bounds, observe
from agent_proc.task.term import ObservationTerm
from agent_proc.task.terms import OWN
from legpush.arrays import Floats
from legpush.errors import ConfigError
from legpush.geometry import Pose2
from legpush.scene.scenario import Room, Scenario
from tests.agent.fake_world import make_scenario, make_state, scenario_at_station
from tests.agent.tasks import paper, tuned

RELATIVE = tuned(scenario=scenario_at_station())
PAPER = paper(scenario=scenario_at_station())
VIEW = push_view(
    make_state(Pose2(x_m=5.3, y_m=3.0, yaw_rad=0.1), Pose2(x_m=6.0, y_m=2.9, yaw_rad=0.1)), RELATIVE.scenario
)


@pytest.mark.parametrize(("task", "n_elements"), [(RELATIVE, 8), (PAPER, 25)], ids=["relative", "paper"])
def test_the_observation_is_within_its_bounds(task: TaskConfig, n_elements: int) -> None:
    observation = observe(task, VIEW)

    low, high = observation_bounds(task)
    assert observation.shape == low.shape == high.shape == (n_elements,)
    assert n_observed(task) == n_elements
    assert observation.dtype == low.dtype == high.dtype == np.float32
    assert ((low <= observation) & (observation <= high)).all()


@pytest.mark.parametrize("task", [RELATIVE, PAPER], ids=["relative", "paper"])
def test_the_observation_has_the_terms_of_the_task_one_after_the_other(task: TaskConfig) -> None:
    sign = VIEW.mirror_sign if task.mirrored else 1.0
    expected = np.concatenate([term.read(VIEW, sign) for term in task.observation_terms.values()])

    np.testing.assert_array_equal(observe(task, VIEW), expected.astype(np.float32))


def test_a_term_may_be_left_out_and_another_one_scaled() -> None:
    task = tuned(observation={"heading": {"scale": -2.0}, "box": {}}, scenario=RELATIVE.scenario)
    low, high = observation_bounds(task)

    np.testing.assert_array_equal(
        observe(task, VIEW),
        (observe(RELATIVE, VIEW) * np.array([1, 1, 0, 0, -2, -2, 0, 0], dtype=np.float32))[[4, 5, 0, 1]],
    )
    assert (low[0], high[0]) == pytest.approx((-2 * np.pi, 2 * np.pi))


@pytest.mark.parametrize("task", [RELATIVE, PAPER], ids=["relative", "paper"])
def test_bounds_are_mapped_to_one_if_asked_for(task: TaskConfig) -> None:
    mapped = replace(task, scaling="bounds")
    low, high = observation_bounds(task)

    np.testing.assert_array_equal(observation_bounds(mapped), [-np.ones(len(low)), np.ones(len(low))])
    np.testing.assert_allclose((observe(mapped, VIEW) + 1) / 2 * (high - low) + low, observe(task, VIEW), atol=1e-5)


def test_nothing_is_mapped_from_a_bound_to_itself() -> None:
    with pytest.raises(ConfigError, match="finite bounds that differ with the scaling `bounds`"):
        observation_bounds(tuned(observation={"box": {"scale": 0.0}}, scaling="bounds"))


class Short(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A term that has fewer elements than axes."""

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """One element."""
        return np.zeros(1)

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """Of one element."""
        return np.zeros(1), np.ones(1)


def test_a_term_with_another_number_of_elements_than_axes_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(OWN, "short", Short)
    task = paper(observation={"short": {}})

    with pytest.raises(ConfigError, match=r"at `observation.short`: expected 3 elements, got shape \(1,\)"):
        observe(task, VIEW)
    with pytest.raises(ConfigError, match=r"at `observation.short`: expected 3 bounds, got shape \(1,\)"):
        observation_bounds(task)


def test_two_observations_of_one_view_share_no_memory() -> None:
    assert not np.shares_memory(observe(PAPER, VIEW), observe(PAPER, VIEW))


def test_the_bounds_follow_the_room_of_the_task() -> None:
    larger = replace(PAPER, scenario=make_scenario(room=Room(size_m=(30.0, 6.0))))

    assert observation_bounds(larger)[1][0] == observation_bounds(PAPER)[1][0] + 18.0
