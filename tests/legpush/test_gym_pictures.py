"""Pictures of the environment: arrays, videos, a window, and the checkers that ask for all of them."""

import os
import warnings
from pathlib import Path

import gymnasium
import imageio_ffmpeg
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import RecordVideo
from stable_baselines3.common.env_checker import check_env as check_env_sb3

from legpush.errors import ConfigError
from sim_proc.render.backends import working_backend

ID = "legpush.gym:legpush/Push-v1"

pytestmark = pytest.mark.skipif(
    working_backend() is None and not os.environ.get("CI"), reason="no OpenGL library draws off screen here"
)


def test_a_picture_shows_the_present_state() -> None:
    env = gymnasium.make(ID, render_mode="rgb_array", width=160, height=120)
    env.reset(seed=1)
    first = np.asarray(env.render())
    assert first.shape == (120, 160, 3)
    assert first.dtype == np.uint8
    np.testing.assert_array_equal(first, np.asarray(env.render()))
    env.step(env.action_space.sample())
    second = np.asarray(env.render())
    assert (first != second).any()
    env.reset(seed=1)
    np.testing.assert_array_equal(first, np.asarray(env.render()))
    env.close()


def test_a_picture_shows_where_a_mission_waits_for_a_push() -> None:
    env = gymnasium.make(
        "legpush.gym:legpush/PushL4-v2", scenario="push", render_mode="rgb_array", width=160, height=120
    )
    env.reset(seed=1)
    first = np.asarray(env.render())
    env.step(env.action_space.sample())
    second = np.asarray(env.render())
    env.close()
    assert first.shape == (120, 160, 3)
    assert (first != second).any()


def test_a_video_has_a_frame_for_the_reset_and_each_step(tmp_path: Path) -> None:
    made = gymnasium.make(ID, render_mode="rgb_array", width=160, height=120, max_episode_steps=2)
    env = RecordVideo(made, str(tmp_path))
    env.reset(seed=1)
    while not env.step(env.action_space.sample())[3]:
        pass
    env.close()  # type: ignore[no-untyped-call]
    (file,) = tmp_path.glob("*.mp4")
    assert imageio_ffmpeg.count_frames_and_secs(str(file))[0] == 3


def test_the_checkers_draw_in_every_mode(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    env = gymnasium.make(ID, render_mode="rgb_array", width=64, height=48)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped)
        check_env_sb3(env)
    env.close()


def test_a_mode_or_size_that_there_is_not_is_refused() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Gymnasium warns of the mode as well
        with pytest.raises(ConfigError, match="Expected one of rgb_array, human for render_mode, got 'ansi'"):
            gymnasium.make(ID, render_mode="ansi")
    with pytest.raises(ConfigError, match="Expected a width and a height from 16"):
        gymnasium.make(ID, render_mode="rgb_array", width=1)


def test_a_picture_needs_a_reset() -> None:
    env = gymnasium.make(ID, render_mode="rgb_array").unwrapped
    with pytest.raises(ConfigError, match="Expected a reset before the first frame"):
        env.render()


def test_a_machine_that_draws_nothing_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    env = gymnasium.make(ID, render_mode="rgb_array")
    env.reset(seed=1)
    monkeypatch.setenv("MUJOCO_GL", "disabled")
    with pytest.raises(ConfigError, match=r"nothing can be drawn: .*MUJOCO_GL=disabled forbids OpenGL"):
        env.unwrapped.render()
