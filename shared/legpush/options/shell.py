"""Options of `legpush doctor`, `legpush health` and `legpush completion`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final, Literal

from legpush.arguments import USUAL_OUTPUT, OutputOptions, Positional, arg
from legpush.bounds import WaitS
from legpush.bus.endpoints import DEFAULT_NAME, DEFAULT_RUN, require_alone
from legpush.bus.secure.certificate_names import CertificateRole
from legpush.fields import Name, require

USUAL_WAIT_S: Final = 3.0


@dataclass(frozen=True, kw_only=True)
class DoctorOptions:
    """Check what this machine has for legpush: libraries, numerics, OpenGL, sockets, temporary files, permissions.

    Exit codes: 0 a mission can run, 1 something that a mission needs is missing.
    """

    output: OutputOptions = USUAL_OUTPUT


@dataclass(frozen=True, kw_only=True)
class HealthOptions:
    """Say whether a process is up: whether its liveliness token is seen on the bus, or a router answers.

    A process shows its token once it is ready; of one that is dead or frozen it is gone after two seconds. With
    `--secure`, the certificate of this role is used. Exit codes: 0 it is up, 1 it is not, 2 bad input.
    """

    role: Positional[Annotated[CertificateRole, arg()]]
    """The role of the process."""
    name: Annotated[str, arg("NAME")] = DEFAULT_NAME
    """Its name; routers and viewers have none."""
    run: Annotated[str, arg("NAME")] = DEFAULT_RUN
    """The run to which it belongs; a router belongs to none."""
    connect: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints on which it listens. If not given, the usual ones of its role."""
    router: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints of routers (`legpush router`) with which it is linked, in the place of --connect."""
    secure: Annotated[Path | None, arg("DIR")] = None
    """Folder of this host that `legpush secure init` made: ask over TLS, with the certificate of this role."""
    wait_s: Annotated[float, arg("S", name="wait")] = USUAL_WAIT_S
    """How long to look for it."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        require(Name, self.name, "--name")
        require(Name, self.run, "--run")
        require(WaitS, self.wait_s, "--wait", "seconds")
        require_alone(self.router, self.connect)


@dataclass(frozen=True, kw_only=True)
class CompletionOptions:
    """Print a script that completes `legpush` commands in a shell when you press Tab.

    bash: `source <(legpush completion bash)` in ~/.bashrc. zsh: `legpush completion zsh > ~/.zfunc/_legpush`, and
    `fpath+=~/.zfunc` before compinit in ~/.zshrc. fish: `legpush completion fish >
    ~/.config/fish/completions/legpush.fish`.
    """

    shell: Positional[Annotated[Literal["bash", "zsh", "fish"], arg()]]
    """The shell."""
