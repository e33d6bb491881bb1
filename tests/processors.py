"""Processes under chosen numerics: without the profile of the tests, or on an emulated processor."""

import os
import shutil
import subprocess
import sys
from typing import Final, Literal

from legpush.numerics.profile import VARIABLE

Processor = Literal["Haswell", "EPYC", "Nehalem"]
"""Models of qemu: two with AVX2 and without AVX-512, and one without AVX2."""
QEMU: Final = "qemu-x86_64"


def plain_environment() -> dict[str, str]:
    """Return the environment of a process that a user starts by hand: without the profile."""
    ours = (VARIABLE, "OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "GLIBC_TUNABLES")
    return {name: value for name, value in os.environ.items() if name not in ours}


def python(*arguments: str, environment: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    """Run Python to its end, without the profile unless `environment` has it."""
    command = [sys.executable, "-P", *arguments]
    env = plain_environment() if environment is None else environment
    return subprocess.run(command, env=env, capture_output=True, text=True, check=False, timeout=250.0)


def qemu() -> str | None:
    """Return the emulator's program; None if it is not installed."""
    return shutil.which(QEMU)


def emulated(processor: Processor, *arguments: str, environment: dict[str, str]) -> str:
    """Return what Python prints on an emulated processor.

    A program that this Python starts is not emulated, so it must not start any, not even itself: `environment` has to
    name its numerics.
    """
    if VARIABLE not in environment:
        raise ValueError(f"Expected {VARIABLE} in the environment of an emulated process")
    command = [QEMU, "-cpu", processor, sys.executable, "-P", *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} ended with {done.returncode}: {done.stderr[-2000:]}")
    return done.stdout
