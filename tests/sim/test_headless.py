"""Simulations load no OpenGL, and leave the environment as it was."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SIMULATE = """
import os, sys
before = os.environ.get("MUJOCO_GL")
from sim_proc.simulator import Simulator
assert os.environ.get("MUJOCO_GL") == before
print(*sorted({"OpenGL", "glfw"} & sys.modules.keys()))
"""


@pytest.mark.parametrize("wish", [None, "nonsense", "osmesa", "egl", "glfw", "", "disabled"])
def test_no_wish_stops_a_simulator_or_makes_it_load_opengl(wish: str | None) -> None:
    environment = {name: value for name, value in os.environ.items() if name != "MUJOCO_GL"}
    environment |= {} if wish is None else {"MUJOCO_GL": wish}
    done = subprocess.run(
        [sys.executable, "-c", SIMULATE], env=environment, check=False, capture_output=True, text=True
    )
    assert (done.returncode, done.stdout.split()) == (0, []), done.stderr


WARN = """
from sim_proc.headless import mujoco
body = '<body><freejoint/><geom size="1"/></body>'
model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
data = mujoco.MjData(model)
data.qvel[0] = 1e30
mujoco.mj_step(model, data)
"""


def test_a_warning_of_mujoco_leaves_no_file_behind(tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, "-c", WARN], cwd=tmp_path, check=True, capture_output=True, text=True)

    assert "QVEL" in done.stderr + done.stdout
    assert list(tmp_path.iterdir()) == []
