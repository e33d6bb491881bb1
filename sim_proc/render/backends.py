"""Finds an OpenGL backend that draws off screen, by trying."""

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from legpush.errors import one_line
from sim_proc.headless import MUJOCO_GL

EGL_DEVICE: Final = "MUJOCO_EGL_DEVICE_ID"
PYOPENGL: Final = "PYOPENGL_PLATFORM"
BACKENDS: Final = ("egl", "osmesa")
"""The backends that draw without a display, in the order in which they are tried."""
ON_DISPLAY: Final = ("glfw", "glx")
"""Backends that need a display; they are tried only if `MUJOCO_GL` names one."""
SWITCHED_OFF: Final = ("disable", "disabled", "off", "false", "0")
"""Values of `MUJOCO_GL` by which a user forbids OpenGL."""
RELEVANT: Final = (MUJOCO_GL, PYOPENGL, EGL_DEVICE, "EGL_PLATFORM", "CUDA_VISIBLE_DEVICES", "DISPLAY")
"""Variables that decide what OpenGL can do."""
LONGEST_S: Final = 60.0
"""A backend that has drawn nothing after this time does not work."""
DRAW_NOTHING: Final = """
import os
try:
    import mujoco
    mujoco.Renderer(mujoco.MjModel.from_xml_string("<mujoco/>"), 8, 8).render()
except BaseException as error:
    print(type(error).__name__, " ".join(str(error).split()), sep=": ", flush=True)
    os._exit(1)
os._exit(0)
"""
"""A program that fails where off-screen rendering does, and says why; what libraries do at exit does not count."""


@dataclass(frozen=True)
class Backend:
    """An OpenGL backend, and the device that it may be bound to."""

    name: str
    any_device: bool = False
    """Whether to disregard `MUJOCO_EGL_DEVICE_ID`."""

    def environment(self, base: Mapping[str, str]) -> dict[str, str]:
        """Return an environment in which MuJoCo uses this backend."""
        dropped = (PYOPENGL, EGL_DEVICE) if self.any_device else (PYOPENGL,)
        kept = {name: value for name, value in base.items() if name not in dropped}
        platform = {PYOPENGL: self.name} if self.name in BACKENDS else {}
        return {**kept, MUJOCO_GL: self.name, **platform}

    def failure(self) -> str | None:
        """Draw in a process of its own; return None if that works, or else why it does not."""
        command = [sys.executable, "-P", "-c", DRAW_NOTHING]
        environment = self.environment(os.environ)
        try:
            done = subprocess.run(
                command,
                env=environment,
                capture_output=True,
                text=True,
                errors="replace",
                check=False,
                timeout=LONGEST_S,
            )
        except subprocess.TimeoutExpired:
            return f"it drew nothing in {LONGEST_S:g} s"
        if done.returncode == 0:
            return None
        said = [line for line in (done.stdout or done.stderr).splitlines() if line.strip()]
        return said[-1] if said else f"it ended with {done.returncode}"


def working_backend() -> Backend | None:
    """Return the first backend that draws, the one that `MUJOCO_GL` names before the others."""
    return try_backends()[0]


def try_backends() -> tuple[Backend | None, list[str]]:
    """Return the first backend that draws, and why those before it do not."""
    failures: list[str] = []
    for backend in _candidates(os.environ):
        failure = backend.failure()
        if failure is None:
            return backend, failures
        failures.append(f"{backend.name}{' on any device' if backend.any_device else ''}: {failure}")
    return None, failures


def _candidates(environment: Mapping[str, str]) -> Iterator[Backend]:
    """Yield the backends to try; none if the user has switched OpenGL off."""
    wish = environment.get(MUJOCO_GL, "").lower().strip()
    if wish in SWITCHED_OFF:
        return
    first = (wish,) if wish in (*BACKENDS, *ON_DISPLAY) else ()
    for name in dict.fromkeys((*first, *BACKENDS)):
        yield Backend(name)
        if name == "egl" and EGL_DEVICE in environment:
            yield Backend(name, any_device=True)


def use_backend(again: str) -> bool:
    """Choose the OpenGL backend of this process and its workers.

    Returns False if no backend draws, after it told the user why, and what to do before running `again`.
    """
    backend, failures = try_backends()
    if backend is None:
        sys.stderr.write(f"{_explanation(failures, again)}\n")
        return False
    environment = backend.environment(os.environ)
    environment["LP_NUM_THREADS"] = "1"  # one thread per worker for Mesa's software renderer
    for name in os.environ.keys() - environment.keys():
        del os.environ[name]
    os.environ.update(environment)
    return True


def _explanation(failures: list[str], again: str) -> str:
    """Return why there is no video, in one line."""
    if not failures:
        return f"No video: {MUJOCO_GL}={one_line(os.environ[MUJOCO_GL])} forbids OpenGL. Unset it and run `{again}`."
    variables = ", ".join(f"{name}={one_line(os.environ[name])}" for name in RELEVANT if name in os.environ)
    cure = f"Set are {variables}: unset what is wrong, or install" if variables else "Install"
    return (
        f"No video: no OpenGL library draws off screen here ({one_line('; '.join(failures))}). {cure} one "
        f"(Debian: libegl1 and libgl1-mesa-dri, or libosmesa6) and run `{again}`."
    )
