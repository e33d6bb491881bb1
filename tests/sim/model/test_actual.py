"""The model of an episode whose robot and floor are not what control takes them to be."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.realism.reality import AS_ASSUMED, Reality
from legpush.scene.scenario import Scenario
from sim_proc.model.actual import actual_robot, tiles
from sim_proc.model.world import build_model
from tests.robots import ROBOT


def test_a_robot_as_assumed_stays_the_same() -> None:
    assert actual_robot(ROBOT, AS_ASSUMED) == ROBOT


def test_a_weak_robot_has_a_share_of_gains_and_torques(at_the_box: Scenario) -> None:
    known, weak = build_model(at_the_box), build_model(at_the_box, Reality(motor_strength=0.8))
    assert weak.actuator_gainprm[:, 0] == pytest.approx(0.8 * known.actuator_gainprm[:, 0])
    assert weak.actuator_biasprm[:, 1:3] == pytest.approx(0.8 * known.actuator_biasprm[:, 1:3])
    assert weak.actuator_forcerange == pytest.approx(0.8 * known.actuator_forcerange)
    torques = actual_robot(ROBOT, Reality(motor_strength=0.8)).joints.knee.torque_by_angle
    assert torques == pytest.approx(np.array(ROBOT.joints.knee.torque_by_angle) * [1.0, 0.8])


def test_friction_payload_and_centre_of_mass_are_those_of_the_episode(at_the_box: Scenario) -> None:
    known = build_model(at_the_box)
    model = build_model(
        at_the_box,
        Reality(
            joint_friction_n_m=0.5,
            payload_kg=5.0,
            payload_m=(0.1, 0.0, 0.2),
            com_offset_m=(0.01, -0.02, 0.0),
            foot_friction=0.4,
        ),
    )
    assert (model.dof_frictionloss[6:18] == 0.5).all()
    assert not model.dof_frictionloss[:6].any()
    assert model.body("payload").mass[0] == 5.0
    assert model.body("payload").pos == pytest.approx([0.1, 0.0, 0.2])
    assert model.body("trunk").ipos - known.body("trunk").ipos == pytest.approx([0.01, -0.02, 0.0])
    assert model.pair("floor:FL_foot").friction[0] == 0.4
    assert (model.nq, model.nu) == (known.nq, known.nu)


def test_tiles_are_as_high_as_drawn_and_not_where_robot_and_box_begin(at_the_box: Scenario) -> None:
    reality = Reality(seed=5, tile_height_m=0.03, tile_size_m=0.25)
    laid = np.array(list(tiles(at_the_box, reality)))
    assert len(laid) > 1800
    assert laid[:, 2].max() <= 0.03
    assert laid[:, 2].mean() == pytest.approx(0.015, rel=0.1)
    for place in (at_the_box.start, at_the_box.box.pose):
        away = np.abs(laid[:, :2] - [place.x_m, place.y_m]).max(axis=1)
        assert away.min() > 0.3
    assert list(tiles(at_the_box, reality)) == list(tiles(at_the_box, reality))
    assert list(tiles(at_the_box, replace(reality, seed=6))) != list(tiles(at_the_box, reality))


def test_feet_and_box_slide_on_tiles_as_on_the_floor(at_the_box: Scenario) -> None:
    small = replace(at_the_box, room=replace(at_the_box.room, size_m=(6.0, 6.0)))
    model = build_model(small, Reality(tile_height_m=0.03, tile_size_m=1.0, foot_friction=0.7))
    assert model.geom("floor").bodyid == model.geom("tile_0").bodyid == model.body("ground").id
    assert model.geom("tile_0").friction[0] == 0.7
    assert model.pair("tile_0:box").friction[0] == at_the_box.box.friction
