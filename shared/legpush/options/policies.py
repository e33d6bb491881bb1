"""Options of `legpush policy`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from legpush.arguments import USUAL_OUTPUT, OutputOptions, Positional, arg
from legpush.errors import ConfigError
from legpush.options.checks import require_writable_folder


@dataclass(frozen=True, kw_only=True)
class ShowPolicy:
    """Print what a trained policy sees and does, and how it was trained."""

    policy: Positional[Annotated[str, arg("POLICY")]]
    """The name of a shipped policy, or a policy folder."""
    output: OutputOptions = USUAL_OUTPUT


@dataclass(frozen=True, kw_only=True)
class ExportPolicy:
    """Write a trained policy for other programs: its weights, and a card with observation, action and training.

    `safetensors` makes a policy folder, also from one of an earlier format. `onnx` makes a model that takes the
    observation as it is measured and gives the action. Exit codes: 0 written, 2 bad input.
    """

    policy: Positional[Annotated[str, arg("POLICY")]]
    """The name of a shipped policy, or a policy folder."""
    to: Annotated[Literal["safetensors", "onnx"], arg()] = "safetensors"
    """Format of the weights."""
    out: Annotated[Path, arg("DIR")] = Path("policy")
    """The new folder."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        if self.out.exists() or not self.out.parent.is_dir():
            raise ConfigError(f"Expected a new folder in an existing one for --out, got {self.out}")
        require_writable_folder(self.out, "--out")
