"""Ticks that MuJoCo runs in one call, against single steps."""

from math import cos, radians

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.scene.conventions import JOINT_QPOS
from legpush.scene.scenario import Rectangle, Scenario
from sim_proc.control.joint_commands import COMMANDS_PER_TICK
from sim_proc.headless import mujoco
from sim_proc.physics.physics import Physics
from sim_proc.physics.state_crc import STATE
from sim_proc.physics.ticks import Ticks
from tests.sim.commands import held


@pytest.fixture(params=["without walls", "beside a wall that appears later"])
def physics(request: pytest.FixtureRequest, at_the_box: Scenario) -> Physics:
    """A robot that stands, with one of its feet in the place of a wall if there is one."""
    start = at_the_box.start.pose()
    foot = Physics(at_the_box, start, at_the_box.box.pose.pose()).tips_m()[0]
    wall = Rectangle(
        x_min_m=foot[0] - 0.1, x_max_m=foot[0] + 0.1, y_min_m=foot[1], y_max_m=foot[1] + 0.5, appears_at_s=0.02
    )
    walls = () if request.param == "without walls" else (wall,)
    scenario = replace(at_the_box, room=replace(at_the_box.room, obstacles=walls))
    physics = Physics(scenario, start, scenario.box.pose.pose())
    for row in physics.data.mocap_pos:
        row[:] = physics.model.body("wall_0").pos
    return physics


def wavering(physics: Physics, n_ticks: int) -> Floats:
    """Joint targets (n, 12) with offsets that change from tick to tick."""
    rng = np.random.default_rng(0)
    joints: Floats = physics.data.qpos[JOINT_QPOS]
    return joints + rng.uniform(-0.03, 0.03, size=(n_ticks, 12))


def state_of(model: mujoco.MjModel, data: mujoco.MjData) -> Floats:
    state = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, state, STATE)
    return state


def test_ticks_are_single_steps_bit_for_bit(physics: Physics) -> None:
    model, data, bare = physics.model, physics.data, mujoco.MjData(physics.model)
    mujoco.mj_setState(model, bare, state_of(model, data), STATE)
    ticks, touched = Ticks(model, data), False
    for n_ticks in (1, 6):
        controls = np.repeat(wavering(physics, n_ticks)[:, None], COMMANDS_PER_TICK, axis=1)
        sensors = np.empty((n_ticks, COMMANDS_PER_TICK, model.nsensordata))
        qpos = ticks.run(model, controls, sensors)
        for tick in range(n_ticks):
            for control, readings in zip(controls[tick], sensors[tick], strict=True):
                bare.ctrl[:] = control
                mujoco.mj_step(model, bare)
                np.testing.assert_array_equal(readings, bare.sensordata)
                touched |= any("wall_0" in {model.geom(geom).name for geom in pair} for pair in bare.contact.geom)
            np.testing.assert_array_equal(qpos[tick], bare.qpos)
        np.testing.assert_array_equal(state_of(model, data), state_of(model, bare))
        np.testing.assert_array_equal(data.site_xpos, bare.site_xpos)
    assert touched == (model.nmocap > 0)


@pytest.fixture
def topples(at_the_box: Scenario) -> Physics:
    """A robot that has begun to fall."""
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())
    physics.data.qvel[1], physics.data.qvel[3] = 3.0, 20.0
    return physics


def test_a_run_ends_with_the_tick_of_a_fall(topples: Physics) -> None:
    """Many ticks go in one call, but none is simulated after the fall."""
    log = topples.run(held(np.repeat(topples.data.qpos[JOINT_QPOS][None], 60, axis=0)))
    assert topples.fallen
    assert 1 < len(log.qpos) == topples.tick < 60
    np.testing.assert_array_equal(log.qpos[-1], topples.data.qpos)
    _, _, heights, _, x, y = log.qpos[:, :6].T
    upright = cos(radians(topples.robot.fall.tilt_deg))
    down = (1 - 2 * (x * x + y * y) < upright) | (heights < topples.robot.fall_height_m)
    assert down.tolist() == [False] * (len(down) - 1) + [True]
