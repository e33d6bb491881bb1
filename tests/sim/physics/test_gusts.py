"""Gusts on the trunk: when they blow, and that they push it."""

import numpy as np
import pytest

from legpush.realism.reality import Reality, drawn_reality
from legpush.realism.settings import Gusts, Realism
from legpush.scene.scenario import Scenario
from sim_proc.control.posture import Posture
from sim_proc.physics.gusts import NEVER, GustSchedule
from sim_proc.physics.physics import Physics


def reality_of(gusts: Gusts) -> Reality:
    return drawn_reality(Realism(gusts=gusts), 0)


def test_there_is_no_change_without_a_gust() -> None:
    assert GustSchedule(Reality(), 1).next_change(0) == NEVER


def test_gusts_begin_and_end_at_ticks() -> None:
    schedule = GustSchedule(reality_of(Gusts(force_n=10.0, duration_s=0.2, at_s=0.1, every_s=1.0)), 1)
    changes, tick = list[int](), -1
    for _ in range(6):
        tick = schedule.next_change(tick)
        changes.append(tick)
    assert changes == [5, 15, 55, 65, 105, 115]


def test_gusts_are_known_again_after_going_back_within_a_run() -> None:
    schedule = GustSchedule(reality_of(Gusts(force_n=10.0, duration_s=0.02, every_s=0.02)), 1)
    schedule.begin_run(10)
    assert schedule.next_change(40) == 41
    assert schedule.next_change(10) == 11


@pytest.mark.parametrize(("direction_deg", "axis"), [(0.0, 0), (90.0, 1)])
def test_a_gust_pushes_the_trunk_in_its_direction(at_the_box: Scenario, direction_deg: float, axis: int) -> None:
    reality = reality_of(Gusts(force_n=100.0, duration_s=0.1, at_s=0.1, direction_deg=direction_deg))
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose(), reality)
    posture = Posture(physics)
    posture.stand(8)
    assert physics.data.xfrc_applied[physics.model.body("trunk").id, axis] == pytest.approx(100.0)
    assert physics.data.qvel[axis] > 0.01
    posture.stand(3)
    assert not physics.data.xfrc_applied.any()
    assert np.isfinite(physics.data.qpos).all()
