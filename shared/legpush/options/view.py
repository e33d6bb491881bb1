"""Options of `legpush view`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

from legpush.arguments import USUAL_OUTPUT, Flag, OutputOptions, Positional, arg
from legpush.bus.endpoints import require_alone
from legpush.errors import ConfigError

EVERYWHERE: Final = "0.0.0.0"  # noqa: S104 (a user has to ask for it)
"""Host that means all addresses of this machine."""
PORT: Final = 8765
MAX_PORT: Final = 65535


@dataclass(frozen=True, kw_only=True)
class ViewOptions:
    """Show a live run or a recording in the browser, on a page of this machine, until Ctrl-C.

    The run is not disturbed: pages can be opened and closed at any time. The page opens only at the
    printed address, which contains a token.
    """

    files: Positional[Annotated[tuple[Path, ...], arg("FILE")]] = ()
    """A recording, or its parts; without any, the live run, or the next one that begins."""
    beside: Annotated[Path | None, arg("FILE")] = None
    """Another recording, such as one of a branch: its longest episode is shown beside the first, at equal times."""
    run: Annotated[str | None, arg("NAME|FOLDER")] = None
    """The run to show, if there are several; if not given, the one in LEGPUSH_RUN."""
    connect: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints of the processes, if no launcher of this machine started them."""
    router: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints of routers (`legpush router`) through which the run is reached, in the place of --connect."""
    secure: Annotated[Path | None, arg("DIR")] = None
    """Folder of this host that `legpush secure init` made: reach the run over TLS alone, as a viewer."""
    host: Annotated[str, arg("ADDRESS")] = "127.0.0.1"
    """Address to listen on; 0.0.0.0 lets other machines open the page, without encryption. A tunnel is safer; it has to
    keep the port, as in ssh -L 8765:127.0.0.1:8765 HOST."""
    port: Annotated[int, arg("N")] = PORT
    """Port to listen on; 0 for any free port."""
    open: Flag = False
    """Open the page in the default browser."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        if self.files and (self.run is not None or self.connect or self.router or self.secure is not None):
            raise ConfigError(
                "Expected either the files of a recording or a live run (--run, --connect, --router, --secure), got "
                "both"
            )
        require_alone(self.router, self.connect)
        if not 0 <= self.port <= MAX_PORT:
            raise ConfigError(f"Expected a port from 0 to {MAX_PORT} for --port, got {self.port}")
