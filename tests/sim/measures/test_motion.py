"""Measures of a real walk and a real push, against calculations of their own from MuJoCo's state at every step."""

from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
import pytest
from shapely import MultiPoint, Point

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.measures import MAX_LANDINGS, Measures
from legpush.messages.stepping import Follow, Outcome, Push, Reset, Walk
from legpush.scene.conventions import JOINT_QPOS, LEGS
from legpush.scene.scenario import Scenario
from sim_proc.headless import mujoco
from sim_proc.measures.motion import Meter
from sim_proc.model.world import JOINT_QVEL, build_model
from sim_proc.simulator import Simulator
from tests.robots import ROBOT
from tests.sim.conftest import standing_at_the_box
from tests.sim.test_observation import log

DT_S = 0.002


@dataclass(kw_only=True)
class Seen:
    """What a bare simulation of the same commands says about each physics step."""

    model: Any
    margins_m: list[float] = field(default_factory=list)
    loads_n: list[list[float]] = field(default_factory=list)
    moments_n_m: list[float] = field(default_factory=list)
    """Magnitude of the horizontal moment while the box presses on a foot."""
    all_moments_n_m: list[list[float]] = field(default_factory=list)
    angular_momenta: list[list[float]] = field(default_factory=list)
    """Of the robot about its centre of mass."""
    torques_n_m: list[list[float]] = field(default_factory=list)
    speeds_rad_s: list[list[float]] = field(default_factory=list)
    work_j: float = 0.0
    loaded: list[bool] = field(default_factory=lambda: [True] * 4)
    n_loadings: int = 0

    def take(self, data: Any, speeds: Floats) -> None:
        """Measure the beginning of a step from its forces, and the speeds of the joints, (12,)."""
        model, com = self.model, data.subtree_com[self.model.body("trunk").id]
        tips = np.array([data.site(f"{leg}_tip").xpos for leg in LEGS])
        loads, moment, pressed = np.zeros(4), np.zeros(3), 0.0
        for index in range(data.ncon):
            contact, force = data.contact[index], np.zeros(6)
            mujoco.mj_contactForce(model, data, index, force)
            names = [model.geom(int(geom)).name for geom in contact.geom]
            legs = [leg for leg in range(4) if f"{LEGS[leg]}_foot" in names]
            if not legs:
                continue
            on_foot = contact.frame.reshape(3, 3).T @ force[:3] * (1.0 if names[1].endswith("_foot") else -1.0)
            moment += np.cross(contact.pos - com, on_foot)
            if "floor" in names:
                loads[legs[0]] += on_foot[2]
            else:
                pressed = float(np.linalg.norm(on_foot))
        for leg in range(4):
            was = self.loaded[leg]
            self.loaded[leg] = loads[leg] > 14.99 or (was and loads[leg] >= 4.998)
            self.n_loadings += self.loaded[leg] and not was
        hull, below = MultiPoint(tips[self.loaded, :2]).convex_hull, Point(com[:2])
        inside = hull.geom_type == "Polygon" and hull.contains(below)
        self.margins_m.append(hull.exterior.distance(below) if inside else -hull.distance(below))
        self.loads_n.append(loads.tolist())
        self.all_moments_n_m.append(moment.tolist())
        self.angular_momenta.append(data.subtree_angmom[model.body("trunk").id].tolist())
        if pressed >= 1.0:
            self.moments_n_m.append(float(np.hypot(*moment[:2])))
        torques = data.actuator_force.copy()
        self.torques_n_m.append(torques.tolist())
        self.speeds_rad_s.append(speeds.tolist())
        self.work_j += float(np.maximum(torques * speeds, 0.0).sum()) * DT_S


def watched(scenario: Scenario, motions: list[Any]) -> tuple[Outcome, Seen]:
    """Carry out motions, and measure the last one a second time from bare steps with the same servo commands."""
    simulator = Simulator()
    simulator.perform(Reset(scenario=scenario, seed=0), with_trace=False)
    for motion in motions[:-1]:
        simulator.perform(motion, with_trace=False)
    assert simulator.episode is not None
    physics = simulator.episode.physics
    state = np.empty(mujoco.mj_stateSize(physics.model, mujoco.mjtState.mjSTATE_INTEGRATION))
    mujoco.mj_getState(physics.model, physics.data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
    controls, run = [], physics.run

    def run_and_keep(*arguments: Any) -> Any:
        done = run(*arguments)
        controls.append(done.ctrl.reshape(-1, 12))
        return done

    physics.run = cast(Any, run_and_keep)  # type: ignore[method-assign]
    outcome = simulator.perform(motions[-1], with_trace=True)
    model = build_model(scenario)
    data, seen = mujoco.MjData(model), Seen(model=model)
    mujoco.mj_setState(model, data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
    for control in np.concatenate(controls):
        data.ctrl[:] = control
        mujoco.mj_step1(model, data)
        speeds = data.qvel[JOINT_QVEL].copy()
        mujoco.mj_step2(model, data)
        seen.take(data, speeds)
    np.testing.assert_allclose(data.qpos, physics.data.qpos, atol=1e-9)
    return outcome, seen


@pytest.fixture(scope="module")
def walk() -> tuple[Outcome, Seen]:
    scenario = standing_at_the_box()
    here = scenario.start.pose()
    path = tuple(here @ Pose2(x_m=-0.1 * index, y_m=0.0, yaw_rad=0.0) for index in range(11))
    return watched(scenario, [Follow(waypoints=path), Walk(), Walk()])


@pytest.fixture(scope="module")
def push() -> tuple[Outcome, Seen]:
    return watched(standing_at_the_box(), [Push(w1=0.3, w2=0.7, leg="FL", depth_m=0.05)])


@pytest.fixture(params=["walk", "push"])
def both(request: pytest.FixtureRequest) -> tuple[Measures, Outcome, Seen]:
    outcome, seen = request.getfixturevalue(request.param)
    assert outcome.measures is not None
    return outcome.measures, outcome, seen


def test_margins_are_those_of_shapely_at_every_physics_step(both: tuple[Measures, Outcome, Seen]) -> None:
    measures, outcome, seen = both
    assert measures.n_steps == len(seen.margins_m)
    assert measures.min_support_margin_m == pytest.approx(min(seen.margins_m), abs=1e-6)
    assert measures.n_outside_support == sum(margin < 0.0 for margin in seen.margins_m)
    assert outcome.trace is not None
    ticks = np.array(seen.margins_m).reshape(-1, 10).min(axis=1)
    np.testing.assert_allclose(outcome.trace.support_margin_m, ticks, atol=1e-6)


def test_torques_speeds_and_work_are_those_of_the_servos(both: tuple[Measures, Outcome, Seen]) -> None:
    measures, outcome, seen = both
    np.testing.assert_allclose(measures.max_torques_n_m, np.abs(seen.torques_n_m).max(axis=0), rtol=1e-6)
    np.testing.assert_allclose(measures.max_speeds_rad_s, np.abs(seen.speeds_rad_s).max(axis=0), rtol=1e-6)
    assert measures.positive_work_j == pytest.approx(seen.work_j, rel=1e-6)
    assert outcome.trace is not None
    np.testing.assert_allclose(outcome.trace.joint_torques_n_m, seen.torques_n_m[9::10], atol=1e-5)
    np.testing.assert_allclose(outcome.trace.joint_velocities_rad_s, seen.speeds_rad_s[9::10], atol=1e-6)


def test_touchdowns_are_those_of_the_contacts(both: tuple[Measures, Outcome, Seen]) -> None:
    measures, _, seen = both
    touching = np.array(seen.loads_n) >= 1.0
    assert measures.n_touchdowns == np.count_nonzero(touching[1:] & ~touching[:-1])
    assert measures.n_loadings == seen.n_loadings
    assert measures.n_footsteps == 4
    assert len(measures.landing_speeds_m_s) >= 4
    assert 0.0 < max(measures.landing_speeds_m_s) < 0.5
    assert 0.0 < measures.max_penetration_m < 0.002


def test_the_push_moment_is_that_of_the_contacts_of_the_feet(push: tuple[Outcome, Seen]) -> None:
    """Friction of the box acts a radius nearer to the box than is assumed: up to 0.02 m times its force."""
    outcome, seen = push
    assert outcome.measures is not None
    assert seen.moments_n_m
    assert outcome.measures.max_push_moment_n_m == pytest.approx(max(seen.moments_n_m), abs=0.3)


def test_the_moment_of_the_feet_is_the_rate_of_change_of_the_angular_momentum(push: tuple[Outcome, Seen]) -> None:
    """So it is not zero, as Eq. 9 says, while legs and trunk move."""
    _, seen = push
    moments = np.array(seen.all_moments_n_m)[:-1, :2]
    rates = np.diff(np.array(seen.angular_momenta), axis=0)[:, :2] / DT_S
    assert np.sqrt(np.square(moments).mean()) > 0.3
    assert np.sqrt(np.square(moments - rates).mean()) < 0.05 * np.sqrt(np.square(moments).mean())


def test_a_walk_presses_on_no_box(walk: tuple[Outcome, Seen]) -> None:
    outcome, seen = walk
    assert not seen.moments_n_m
    assert outcome.measures is not None
    assert outcome.measures.max_push_moment_n_m is None


def test_nothing_is_measured_where_nothing_moves(at_the_box: Scenario) -> None:
    simulator = Simulator()
    assert simulator.perform(Reset(scenario=at_the_box, seed=0), with_trace=True).measures is None
    path = (at_the_box.start.pose(), at_the_box.start.pose() @ Pose2(x_m=-0.5, y_m=0.0, yaw_rad=0.0))
    assert simulator.perform(Follow(waypoints=path), with_trace=True).measures is None


def test_of_many_landings_the_fastest_are_kept() -> None:
    loads = np.zeros((40 * (MAX_LANDINGS + 10), 4))
    loads[39::40, 0] = 30.0
    ticks = log(len(loads), np.zeros(4))
    ticks.floor_forces_n[:, :, 2] = loads
    fall_m = np.linspace(0.0, 0.001, len(loads))
    ticks.tips_m[:, 0, 2] = 1.0 - np.cumsum(fall_m)
    measures = Meter(ROBOT, np.zeros(2)).measure([ticks], n_footsteps=0).measures
    assert len(measures.landing_speeds_m_s) == MAX_LANDINGS
    expected = np.sort(fall_m[39::40] / DT_S)[-MAX_LANDINGS:]
    np.testing.assert_allclose(measures.landing_speeds_m_s, expected, rtol=1e-6)


def test_joint_angles_keep_their_distance_from_the_limits(both: tuple[Measures, Outcome, Seen]) -> None:
    measures, outcome, _ = both
    assert outcome.trace is not None
    angles = np.array(outcome.trace.qpos)[:, JOINT_QPOS]
    low, high = np.array([joint.limits_rad for joint in ROBOT.joints.in_order()] * 4).T
    of_ticks = np.minimum(angles - low, high - angles).min(axis=0)
    least = np.array(measures.least_to_limits_rad)
    assert (least <= of_ticks + 2e-2).all()
    assert (least >= of_ticks - 2e-2).all()
