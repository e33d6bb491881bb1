"""Checks the machine: numerics, OpenGL, sockets, folders, cores and memory."""

import os
import resource
import shutil
import socket
import subprocess
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from tempfile import gettempdir
from typing import Final

import msgspec
import psutil

from legpush.bus.endpoints import local, own_directory, prepare
from legpush.doctor.finding import Finding
from legpush.errors import EndpointError, LegpushError
from legpush.numerics.profile import X86_64_V3, why_not_here
from legpush.options.checks import require_writable_folder
from legpush.processes.environment import child_environment
from legpush.processes.start_program import program_command
from legpush.runs.live_runs import find_live_runs, socket_directory

SPACE_BYTES: Final = 500_000_000
"""A mission with a film takes about 10 MB, a training less; below this, a folder gets a note."""
MEMORY_BYTES: Final = 2_000_000_000
"""The three processes of a mission take about 0.7 GB."""
N_FILES: Final = 1024
"""Least number of open files for trainings with many simulators."""
LONGEST_S: Final = 120.0
CURE_OPENGL: Final = "Debian: apt install libegl1 libgl1-mesa-dri, or libosmesa6"


class Drawing(msgspec.Struct, frozen=True, kw_only=True):
    """What `sim_proc.render.probe` prints."""

    backend: str | None
    """The first backend that draws."""
    failures: tuple[str, ...]
    """Why those before it do not."""


def numerics_finding() -> Finding:
    """Return which bits the processes of a mission compute."""
    if why := why_not_here():
        return Finding(name="numerics", state="note", detail=f"native: {why}", cure="other machines may get other bits")
    return Finding(name="numerics", state="ok", detail=f"profile {X86_64_V3}; `legpush canary` computes a check sum")


def opengl_finding() -> Finding:
    """Return whether films can be made here, which only a trial in a process of its own shows."""
    try:
        done = subprocess.run(
            program_command("sim_proc.render.probe", ()),
            env=child_environment(os.environ),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
            timeout=LONGEST_S,
        )
        drawing = msgspec.json.decode(done.stdout, type=Drawing)
    except subprocess.TimeoutExpired:
        return Finding(name="opengl", state="note", detail=f"no answer within {LONGEST_S:g} s", cure=CURE_OPENGL)
    except msgspec.DecodeError:
        return Finding(name="opengl", state="note", detail="cannot be tried without the simulator's libraries")
    if drawing.backend is None:
        detail = "; ".join(drawing.failures) or "MUJOCO_GL forbids OpenGL"
        return Finding(name="opengl", state="note", detail=f"no film can be made: {detail}", cure=CURE_OPENGL)
    others = f" ({'; '.join(drawing.failures)})" if drawing.failures else ""
    return Finding(name="opengl", state="ok", detail=f"{drawing.backend} draws off screen{others}")


def socket_findings() -> Iterator[Finding]:
    """Yield whether processes that are started by hand can listen, and those of a launcher."""
    try:
        prepare(local("sim"))
    except EndpointError as error:
        yield Finding(
            name="own sockets",
            state="note",
            detail=str(error),
            cure="processes that are started by hand need --listen and --connect; `legpush run` does not use it",
        )
    else:
        yield Finding(name="own sockets", state="ok", detail=f"processes started by hand meet in {own_directory()}")
    try:
        with socket_directory() as folder, closing(socket.socket(socket.AF_UNIX)) as end:
            end.bind(str(folder / "planner.sock"))
    except (OSError, LegpushError) as error:
        yield Finding(
            name="sockets",
            state="missing",
            detail=f"no unix socket in {gettempdir()}: {error}",
            cure="set TMPDIR to a folder of this machine with a short path",
        )
    else:
        yield Finding(name="sockets", state="ok", detail=f"unix sockets can be made in {folder.parent}")


def folder_findings() -> Iterator[Finding]:
    """Yield whether files can be written where missions write them, and how much space there is."""
    for name, folder in (("temporary files", Path(gettempdir())), ("results", Path("runs").absolute())):
        try:
            require_writable_folder(folder, name)
        except LegpushError as error:
            yield Finding(name=name, state="missing", detail=str(error), cure="set TMPDIR, or --out to another folder")
            continue
        there = next(each for each in (folder, *folder.parents) if each.exists())
        free = shutil.disk_usage(there).free
        yield Finding(
            name=name,
            state="ok" if free >= SPACE_BYTES else "note",
            detail=f"{folder}: {free / 1e9:.1f} GB free",
            cure="" if free >= SPACE_BYTES else "make space, or set TMPDIR or --out to another disk",
        )


def resource_findings() -> Iterator[Finding]:
    """Yield cores, memory, open files and live runs."""
    n_cores, load = len(os.sched_getaffinity(0)), os.getloadavg()[0]
    yield Finding(name="cores", state="ok", detail=f"{n_cores} for this process, load {load:.1f}")
    free = psutil.virtual_memory().available
    yield Finding(
        name="memory",
        state="ok" if free >= MEMORY_BYTES else "note",
        detail=f"{free / 1e9:.1f} GB available",
        cure="" if free >= MEMORY_BYTES else "a mission takes about 0.7 GB: end other programs",
    )
    n_files = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    yield Finding(
        name="open files",
        state="ok" if n_files >= N_FILES else "note",
        detail=f"at most {n_files}",
        cure="" if n_files >= N_FILES else f"ulimit -n {N_FILES}, for trainings with many simulators",
    )
    runs = find_live_runs()
    yield Finding(name="live runs", state="ok", detail=", ".join(map(str, runs)) or "none")
