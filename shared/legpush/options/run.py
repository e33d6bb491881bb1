"""Options of `legpush run` and `legpush router`."""

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from legpush.arguments import USUAL_OUTPUT, Flag, OutputOptions, Positional, Switch, arg
from legpush.bounds import WaitS
from legpush.errors import ConfigError
from legpush.fields import Seed, require
from legpush.options.checks import program_path, require_new_file
from legpush.options.scenarios import Changes, ScenarioName, changed_scenario
from legpush.policy_names import DEFAULT_POLICY, require_trust
from legpush.scene.names import PlannerName

if TYPE_CHECKING:
    from legpush.scene.scenario import Scenario


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Run a mission: start planner, simulator and agent, watch over them, and report.

    Exit codes: 0 the box is at its goal, 1 it is not, 2 bad input, 3 gave up on a process, 5 the disk
    is full, 130 interrupted.
    """

    scenario: Positional[ScenarioName] = "default"
    """A built-in scenario (`legpush scenarios list`) or the path of a scenario file."""
    changes: Changes = ()
    """Change a field of the scenario, such as box.mass_kg=0.9 or planning.steering=dubins; may be given several
    times."""
    seed: Annotated[int, arg("N")] = 0
    """Seed of the offsets of start and box, and of the path. Equal seeds give equal missions, bit for bit."""
    out: Annotated[Path | None, arg("DIR")] = None
    """Folder of the run; `runs/<time>-<scenario>-seed<N>` if not given. An unfinished run in this folder continues."""
    policy: Annotated[str, arg("POLICY")] = DEFAULT_POLICY
    """Policy that chooses the pushes: scripted, dynamic_programming, the name of a shipped policy, a policy folder, a
    model file (.zip), or module:factory."""
    trust_policy_file: Flag = False
    """Load a model file (.zip) of Stable-Baselines3. It is a pickle: loading it runs any code in it."""
    push_map: Annotated[Path | None, arg("FILE")] = None
    """Push map of this box, measured by `legpush calibrate`. If not given, that of the default box is scaled."""
    planner_command: Annotated[str | None, arg("COMMAND")] = None
    """Another planner process, such as "python examples/grid_planner.py"; `docs/protocol.md` says what it must do."""
    planner: Annotated[PlannerName | None, arg()] = None
    """Replaces the scenario's search for paths, `planning.planner`."""
    record: Annotated[Path | None, arg("FILE")] = None
    """Record all messages of the processes into this new MCAP file; see `legpush replay`."""
    secure: Annotated[Path | None, arg("DIR")] = None
    """Folder of this host that `legpush secure init` made: the processes talk over TLS at ports of 127.0.0.1, instead
    of over sockets in a private folder."""
    picture: Switch = True
    """Draw mission.png at the end."""
    video: Switch = True
    """Render mission.mp4 at the end."""
    deadline_s: Annotated[float | None, arg("S", name="deadline")] = None
    """Give up if the mission is not over after this many seconds."""
    inject_faults: Annotated[float, arg("P")] = 0.0
    """For tests: drop, duplicate, delay and reorder messages between the processes, each with this probability."""
    dry_run: Flag = False
    """Check everything that can be wrong, print the scenario with all changes, and start nothing."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        require(Seed, self.seed, "--seed")
        require_trust(self.policy, self.trust_policy_file)
        if not 0.0 <= self.inject_faults < 1.0:
            raise ConfigError(f"Expected a probability in [0, 1) for --inject-faults, got {self.inject_faults}")
        if self.record is not None:
            require_new_file(self.record, "--record")
        if self.planner_command is not None:
            split_command(self.planner_command)
            if self.secure is not None:
                raise ConfigError(
                    "Expected either --planner-command or --secure, got both: start such a planner by hand"
                )
        require(WaitS, self.deadline_s, "--deadline", "seconds")

    def resolved_scenario(self) -> "Scenario":
        """Return the scenario, with the values that these options replace.

        Raises:
            ScenarioError: The scenario, or a value of these options, cannot be used.
        """
        return changed_scenario(self.scenario, self.given_changes())

    def given_changes(self) -> tuple[str, ...]:
        """Return the changes of the scenario, as `--set` takes them."""
        return self.changes if self.planner is None else (*self.changes, f"planning.planner={self.planner}")


@dataclass(frozen=True, kw_only=True)
class RouterOptions:
    """Pass messages on between processes that are started with --router, until Ctrl-C: Zenoh's router.

    Several routers may be linked. Each process then needs to reach one of them. Exit codes: 0 ended, 2 bad input.
    """

    listen: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints to listen on. If not given, the socket router.sock in the folder of this user, /tmp/legpush.UID;
    with --secure, tls/127.0.0.1:17470."""
    connect: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints of other routers, which may start later."""
    secure: Annotated[Path | None, arg("DIR")] = None
    """Folder of this host that `legpush secure init --routers HOST` made: talk over TLS alone, and let each
    certificate say and hear what its role may."""
    print_config: Flag = False
    """Print the same configuration as a file for `zenohd --config`, and end."""
    log_level: Annotated[Literal["debug", "info", "warning", "error"], arg()] = "info"
    """The least severe lines of the log on standard error."""
    output: OutputOptions = USUAL_OUTPUT


def split_command(command: str) -> tuple[str, ...]:
    """Split the command of a planner into its program, with its absolute path, and the arguments.

    Raises:
        ConfigError: The text cannot be parsed, or there is no such program.
    """
    try:
        words = shlex.split(command)
    except ValueError as error:
        raise ConfigError(f"Expected a command for --planner-command, got {command!r} ({error})") from error
    if not words:
        raise ConfigError("Expected a command for --planner-command, got nothing")
    return (program_path(words[0]), *words[1:])
