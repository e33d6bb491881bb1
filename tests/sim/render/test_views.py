"""Where films are seen from: every view has what it is named after in the frame."""

import os
import pickle
import subprocess
import sys
from math import tan
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from legpush.arrays import Floats
from legpush.history.timeline import Timeline
from legpush.messages.stepping import Motion, Push, Reset
from legpush.options.formats import View
from legpush.scene.scenario import Scenario
from sim_proc.render.backends import working_backend
from sim_proc.render.film import Film, film_of
from sim_proc.render.views import FIELD_OF_VIEW_RAD, look
from sim_proc.simulator import Simulator

PHOTOGRAPH = """
import pickle, sys
from pathlib import Path
import numpy as np
from sim_proc.render.camera import Camera, FrameSize
folder = Path(sys.argv[1])
film = pickle.loads((folder / "film").read_bytes())
for view in sys.argv[2:]:
    camera = Camera(film, FrameSize(width=160, height=90), view)
    np.save(folder / f"{view}.npy", camera.frame(50))
    camera.close()
"""
"""Saves a frame of every view."""
VIEWS: tuple[View, ...] = get_args(View)
ASPECT = 16 / 9


@pytest.fixture
def film(at_the_box: Scenario) -> Film:
    simulator, timeline = Simulator(), Timeline(at_the_box)
    motions: list[Motion] = [Reset(scenario=at_the_box, seed=0), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.1)]
    for number, motion in enumerate(motions):
        timeline.add(number, motion, simulator.perform(motion, with_trace=True), 0)
    return film_of(timeline, "here")


def seen_at(film: Film, view: View, row: int, point_m: Floats) -> Floats:
    """Place in the frame, x to the right and y up, from -1 to 1 each; not finite behind the camera."""
    place = look(film, view, row, ASPECT)
    azimuth, elevation = place.azimuth_rad, place.elevation_rad
    forward = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    right = np.array([np.sin(azimuth), -np.cos(azimuth), 0.0])
    away = point_m - (place.at_m - place.distance_m * forward)
    depth = away @ forward
    assert depth > 0.0
    half = tan(FIELD_OF_VIEW_RAD / 2) * depth
    seen: Floats = np.array([away @ right / (half * ASPECT), away @ np.cross(right, forward) / half])
    return seen


@pytest.mark.parametrize("view", VIEWS)
def test_a_view_has_the_robot_or_the_box_in_it_all_the_time(film: Film, view: View) -> None:
    columns = slice(19, 22) if view == "box" else slice(0, 3)
    places = [seen_at(film, view, row, film.qpos[row, columns]) for row in range(0, len(film.qpos), 10)]
    assert len(places) > 5
    assert np.abs(places).max() < (1.0 if view == "room" else 0.5)


def test_the_room_is_seen_from_corner_to_corner_with_y_up(film: Film) -> None:
    x, y = film.scenario.room.size_m
    places = ((0.0, 0.0), (x, 0.0), (0.0, y), (x, y))
    corners = np.array([seen_at(film, "room", 0, np.array([*place, 0.0])) for place in places])
    assert np.abs(corners).max() < 1.0
    assert np.abs(corners).max() > 0.85
    assert (corners[[1, 3], 0] > 0.0).all()
    assert (corners[[2, 3], 1] > 0.0).all()


def test_front_looks_back_along_the_heading_and_rear_along_it(film: Film) -> None:
    assert seen_at(film, "front", 0, film.qpos[0, 19:22])[1] < seen_at(film, "front", 0, film.qpos[0, :3])[1]
    assert seen_at(film, "rear", 0, film.qpos[0, 19:22])[1] > seen_at(film, "rear", 0, film.qpos[0, :3])[1] - 0.3
    side = [seen_at(film, "side", 0, film.qpos[0, columns])[0] for columns in (slice(0, 3), slice(19, 22))]
    assert side[1] - side[0] > 0.3


def test_the_orbit_turns(film: Film) -> None:
    turned = look(film, "orbit", 100, ASPECT).azimuth_rad - look(film, "orbit", 0, ASPECT).azimuth_rad
    assert turned == pytest.approx(2 * np.pi * 2.0 / 60.0)


def test_every_camera_shows_another_picture(film: Film, tmp_path: Path) -> None:
    backend = working_backend()
    if backend is None:
        pytest.skip("no OpenGL library for off-screen rendering")
    (tmp_path / "film").write_bytes(pickle.dumps(film))
    command = [sys.executable, "-P", "-c", PHOTOGRAPH, str(tmp_path), *VIEWS]
    done = subprocess.run(
        command, env=backend.environment(os.environ), capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stderr
    pictures = {view: np.load(tmp_path / f"{view}.npy").astype(np.float64) for view in VIEWS}
    for view, picture in pictures.items():
        assert picture.shape == (90, 160, 3)
        assert picture.std() > 8.0
        assert (picture >= 250).all(axis=2).mean() < 0.2, f"{view} is overexposed"
    differences = [
        np.abs(pictures[one] - pictures[other]).mean() for i, one in enumerate(VIEWS) for other in VIEWS[i + 1 :]
    ]
    assert len(differences) == len(VIEWS) * (len(VIEWS) - 1) // 2
    assert min(differences) > 3.0
