"""Options of `legpush doctor` and `legpush completion`."""

from dataclasses import dataclass
from typing import Annotated, Literal

from legpush.arguments import USUAL_OUTPUT, OutputOptions, Positional, arg


@dataclass(frozen=True, kw_only=True)
class DoctorOptions:
    """Check what this machine has for legpush: libraries, numerics, OpenGL, sockets, temporary files, permissions.

    Exit codes: 0 a mission can run, 1 something that a mission needs is missing.
    """

    output: OutputOptions = USUAL_OUTPUT


@dataclass(frozen=True, kw_only=True)
class CompletionOptions:
    """Print a script that completes `legpush` commands in a shell when you press Tab.

    bash: `source <(legpush completion bash)` in ~/.bashrc. zsh: `legpush completion zsh > ~/.zfunc/_legpush`, and
    `fpath+=~/.zfunc` before compinit in ~/.zshrc. fish: `legpush completion fish >
    ~/.config/fish/completions/legpush.fish`.
    """

    shell: Positional[Annotated[Literal["bash", "zsh", "fish"], arg()]]
    """The shell."""
