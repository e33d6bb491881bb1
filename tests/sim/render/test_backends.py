"""Which OpenGL backend a film uses, and what the user is told where none works."""

import os
from pathlib import Path

import pytest

from sim_proc.render import backends
from sim_proc.render.backends import DRAW_NOTHING, Backend, use_backend, working_backend

VARIABLES = (*backends.RELEVANT, "LP_NUM_THREADS")


@pytest.fixture
def environment(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Without variables that a backend depends on; changes of `os.environ` are undone."""
    monkeypatch.setattr(os, "environ", os.environ.copy())
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)
    return monkeypatch


def draws_where(condition: str) -> str:
    """A program that stands for one that draws."""
    return f"import os, sys\nprint('no', os.environ['MUJOCO_GL'])\nsys.exit(not ({condition}))"


def test_the_program_says_in_one_line_why_it_cannot_draw(environment: pytest.MonkeyPatch) -> None:
    failure = Backend("nonsense").failure()
    assert failure == "RuntimeError: invalid value for environment variable MUJOCO_GL: nonsense"
    environment.setattr(backends, "DRAW_NOTHING", DRAW_NOTHING.replace("mujoco", "missing_library"))
    assert Backend("egl").failure() == "ModuleNotFoundError: No module named 'missing_library'"


@pytest.mark.parametrize(
    ("program", "failure"),
    [
        ("import os; os.abort()", "it ended with -6"),
        ("print('first'); print('why'); raise SystemExit(3)", "why"),
        ("import time; time.sleep(60)", "it drew nothing in 0.3 s"),
    ],
)
def test_a_backend_that_ends_in_any_way_but_well_does_not_work(
    program: str, failure: str, environment: pytest.MonkeyPatch
) -> None:
    environment.setattr(backends, "DRAW_NOTHING", program)
    environment.setattr(backends, "LONGEST_S", 0.3 if "sleep" in program else 30.0)
    assert Backend("egl").failure() == failure


WORKS: dict[str, tuple[dict[str, str], str, Backend | None]] = {
    "nothing set": ({}, "True", Backend("egl")),
    "the second one": ({}, "os.environ['MUJOCO_GL'] == 'osmesa'", Backend("osmesa")),
    "the wish": ({"MUJOCO_GL": " OSMesa"}, "True", Backend("osmesa")),
    "a wish that does not work": ({"MUJOCO_GL": "glfw"}, "os.environ['MUJOCO_GL'] != 'glfw'", Backend("egl")),
    "nonsense": ({"MUJOCO_GL": "nonsense"}, "True", Backend("egl")),
    "on": ({"MUJOCO_GL": "on"}, "True", Backend("egl")),
    "switched off": ({"MUJOCO_GL": "disabled"}, "True", None),
    "another platform": (
        {"PYOPENGL_PLATFORM": "x11"},
        "os.environ['PYOPENGL_PLATFORM'] == os.environ['MUJOCO_GL']",
        Backend("egl"),
    ),
    "a device that is there": ({"MUJOCO_EGL_DEVICE_ID": "0"}, "True", Backend("egl")),
    "a device that is not there": (
        {"MUJOCO_EGL_DEVICE_ID": "3"},
        "'MUJOCO_EGL_DEVICE_ID' not in os.environ",
        Backend("egl", any_device=True),
    ),
}


@pytest.mark.parametrize(("variables", "condition", "backend"), WORKS.values(), ids=WORKS)
def test_the_first_backend_that_draws_is_used(
    variables: dict[str, str], condition: str, backend: Backend | None, environment: pytest.MonkeyPatch
) -> None:
    for name, value in variables.items():
        environment.setenv(name, value)
    environment.setattr(backends, "DRAW_NOTHING", draws_where(condition))
    assert working_backend() == backend
    assert use_backend("again") == (backend is not None)
    if backend is not None:
        assert os.environ["MUJOCO_GL"] == backend.name
        assert os.environ["PYOPENGL_PLATFORM"] == backend.name
        assert ("MUJOCO_EGL_DEVICE_ID" in os.environ) == (
            "MUJOCO_EGL_DEVICE_ID" in variables and not backend.any_device
        )


def test_where_nothing_draws_the_user_is_told_why_what_is_set_and_what_to_do(
    environment: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    environment.setenv("MUJOCO_GL", "glfw")
    environment.setenv("MUJOCO_EGL_DEVICE_ID", "\x1b3")
    environment.setattr(backends, "DRAW_NOTHING", draws_where("False"))
    assert not use_backend("legpush render there")
    assert capsys.readouterr().err == (
        "No video: no OpenGL library draws off screen here (glfw: no glfw; egl: no egl; egl on any device: no egl; "
        "osmesa: no osmesa). Set are MUJOCO_GL=glfw, MUJOCO_EGL_DEVICE_ID=\\x1b3: unset what is wrong, or install one "
        "(Debian: libegl1 and libgl1-mesa-dri, or libosmesa6) and run `legpush render there`.\n"
    )
    environment.setenv("MUJOCO_GL", "Off")
    assert not use_backend("legpush export")
    assert capsys.readouterr().err == "No video: MUJOCO_GL=Off forbids OpenGL. Unset it and run `legpush export`.\n"


def test_a_real_wish_that_cannot_work_costs_no_film(environment: pytest.MonkeyPatch, tmp_path: Path) -> None:
    if (usual := working_backend()) is None:
        pytest.skip("no OpenGL library for off-screen rendering")
    environment.setenv("MUJOCO_GL", "glfw")
    environment.setenv("DISPLAY", ":99999")
    environment.setenv("PYOPENGL_PLATFORM", "x11")
    environment.setenv("MUJOCO_EGL_DEVICE_ID", "99")
    found = working_backend()
    assert found is not None
    assert found.name == usual.name
