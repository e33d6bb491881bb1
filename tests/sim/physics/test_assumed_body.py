"""What control takes the robot to be."""

import numpy as np
import pytest

from legpush.realism.reality import Reality
from legpush.scene.scenario import Scenario
from sim_proc.model.world import build_model
from sim_proc.physics.assumed_body import AssumedBody, downhill_of
from sim_proc.physics.physics import Physics


def test_its_centre_of_mass_is_that_of_the_simulated_robot_if_nothing_differs(at_the_box: Scenario) -> None:
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())
    body = AssumedBody(build_model(at_the_box))
    assert body.com_m(physics.data.qpos) == pytest.approx(physics.com_m(), abs=1e-12)
    assert body.mass_kg == physics.mass_kg
    assert (body.downhill == downhill_of(physics.model)).all()


def test_control_knows_neither_payload_nor_offset_nor_slope(at_the_box: Scenario) -> None:
    places = at_the_box.start.pose(), at_the_box.box.pose.pose()
    reality = Reality(payload_kg=10.0, payload_m=(0.2, 0.0, 0.1), com_offset_m=(0.02, 0.0, 0.0), slope_deg=5.0)
    known, hidden = Physics(at_the_box, *places), Physics(at_the_box, *places, reality)
    assert hidden.mass_kg == known.mass_kg
    assert hidden.com_m() == pytest.approx(known.com_m(), abs=1e-12)
    assert (hidden.downhill == known.downhill).all()
    assert hidden.model.body_subtreemass[hidden.model.body("trunk").id] == pytest.approx(known.mass_kg + 10.0)
    assert np.hypot(*hidden.actual_downhill) == pytest.approx(np.tan(np.radians(5.0)))
