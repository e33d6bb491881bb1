"""What is written into a frame of a film."""

import numpy as np
import pytest

from legpush.history.timeline import Timeline
from legpush.messages.stepping import Motion, Push, Reset
from legpush.scene.scenario import Scenario
from sim_proc.render.caption import caption
from sim_proc.render.film import Film, film_of
from sim_proc.simulator import Simulator


@pytest.fixture
def film(at_the_box: Scenario) -> Film:
    simulator, timeline = Simulator(), Timeline(at_the_box)
    motions: list[Motion] = [Reset(scenario=at_the_box, seed=0), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.1)]
    for number, motion in enumerate(motions):
        timeline.add(number, motion, simulator.perform(motion, with_trace=True), 0)
    return film_of(timeline, "here")


def test_the_caption_has_time_phase_error_and_speeds(film: Film) -> None:
    goal, box = film.scenario.goal.pose, film.qpos[60, 19:21]
    lines = dict(caption(film, 60, 3.0))
    assert lines["time"] == f"{(film.first_tick + 60) * 0.02:.1f} s"
    assert lines["phase"] == "pushing"
    error_m = float(np.hypot(box[0] - goal.x_m, box[1] - goal.y_m))
    assert lines["box error"].startswith(f"{error_m:.3f} m, ")
    assert lines["robot"].endswith(" m/s")
    assert lines["film"] == "3.0 x real time"
    assert "".join(map("".join, lines.items())).isascii()


def test_every_row_has_a_caption(film: Film) -> None:
    assert dict(caption(film, 0, 3.0))["phase"] == "standing"
    assert all(len(caption(film, row, 3.0)) == 5 for row in (0, 1, len(film.qpos) - 1))
