"""Options of `legpush python`, `kernel` and `canary`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from legpush.arguments import USUAL_OUTPUT, OutputOptions, arg


@dataclass(frozen=True, kw_only=True)
class PythonOptions:
    """Start Python under the numerics profile: `legpush python ARGUMENTS...`, with the arguments of Python itself.

    `legpush.run` then ends in the `state_crc` of `legpush run`, on every x86-64 machine with AVX2.
    """


@dataclass(frozen=True, kw_only=True)
class KernelOptions:
    """Install a Jupyter kernel that starts this Python under the numerics profile; it needs the package ipykernel."""

    name: Annotated[str, arg("NAME")] = "legpush"
    """Name of its folder."""
    prefix: Annotated[Path | None, arg("DIR")] = None
    """Install into DIR/share/jupyter/kernels, such as the folder of a virtual environment, instead of the user's."""
    output: OutputOptions = USUAL_OUTPUT


@dataclass(frozen=True, kw_only=True)
class CanaryOptions:
    """Print the numerics of this machine, and a short computation's CRC to compare with that of another machine.

    Exit codes: 0 it is the published one, or none was published for these numerics; 1 it is another one.
    """

    output: OutputOptions = USUAL_OUTPUT
