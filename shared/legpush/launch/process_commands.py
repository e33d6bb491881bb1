"""Makes the command lines of the three processes of a mission."""

import shlex
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from legpush.bus.endpoints import Endpoints, in_directory, on_loopback
from legpush.bus.secure.host_folder import credentials_of
from legpush.launch.film import film_arguments
from legpush.messages.common import Role
from legpush.options.run import RunOptions, split_command
from legpush.policy_names import TRUST_FILE
from legpush.processes.environment import RECORDED
from legpush.recording.facts import MissionFacts
from legpush.runs.folder import SCENARIO_FILE, run_name


@dataclass(frozen=True, kw_only=True)
class Place:
    """The folders of a run."""

    folder: Path
    """The folder for the results of the run; absolute."""
    sockets: Path
    """A directory of mode 0700 for the sockets of its processes."""
    secure: Path | None = None
    """The folder of this host, for processes that talk over TLS instead."""
    ports: Mapping[Role, int] = field(default_factory=dict)
    """Their ports of 127.0.0.1."""

    @property
    def run(self) -> str:
        """The name of the run on the bus."""
        return run_name(self.folder)

    def endpoints(self, role: Role) -> Endpoints:
        """Return where a process of the run listens and connects.

        Raises:
            EndpointError: The directory of the sockets cannot be used.
            CredentialsError: The certificate of the process cannot be used.
        """
        credentials = credentials_of(self.secure, role)
        if credentials is None:
            return in_directory(self.sockets, role)
        return on_loopback(role, self.ports, credentials)


def process_arguments(role: Role, options: RunOptions, place: Place) -> tuple[str, ...]:
    """Return the command line of a process, without the flags that `bus_flags` adds."""
    if role == "planner" and options.planner_command is not None:
        return split_command(options.planner_command)
    # -P: files in the working directory are not part of the program.
    process = (sys.executable, "-P", "-m", f"{role}_proc")
    return process + agent_flags(options, place) if role == "agent" else process


def agent_flags(options: RunOptions, place: Place) -> tuple[str, ...]:
    """Return the flags of the agent, without those that `bus_flags` adds."""
    flags = ["--scenario", str(place.folder / SCENARIO_FILE), "--seed", str(options.seed)]
    flags += ["--out", str(place.folder), "--policy", options.policy]
    if options.trust_policy_file:
        flags += [TRUST_FILE]
    if options.push_map is not None:
        flags += ["--push-map", str(options.push_map.absolute())]
    if not options.picture:
        flags += ["--no-picture"]
    if options.record is not None and options.planner_command is not None:
        flags += ["--witness-planner"]
    if options.planner_command is not None:
        flags += ["--planner-command", options.planner_command]
    flags += ["--command", shlex.join(["legpush", *sys.argv[1:]])]
    return tuple(flags)


def recorded_policy_flags(facts: MissionFacts, policy: str | None, repeated: str | None) -> tuple[str, ...]:
    """Return the flags for the agent about the policy of a recording.

    `policy` is the one that the user wants, None for the recorded one, and `repeated` the recorded one as the user
    repeated it.
    """
    is_recorded = policy in (None, facts.policy)
    flags = ("--recorded-policy-sha256", facts.policy_sha256) if is_recorded else ()
    return flags if repeated is None else (*flags, "--repeated-policy", repeated)


@dataclass(frozen=True, kw_only=True)
class Programs:
    """The programs that a mission starts."""

    process: Callable[[Role, RunOptions, Place], tuple[str, ...]] = process_arguments
    agent_flags: tuple[str, ...] = ()
    """Further flags of the agent."""
    film: Callable[[Path], tuple[str, ...]] = film_arguments
    again: Callable[[Path], str] | None = None
    """Makes the command that continues an interrupted run in its folder; without it, that is `legpush run`."""
    kind: str = "run"
    """The subcommand of `legpush` that runs the mission."""


def bus_flags(role: Role, options: RunOptions, place: Place) -> tuple[str, ...]:
    """Return the flags for the endpoints of a process, for injected faults and for recording."""
    endpoints = place.endpoints(role)
    flags = ["--run", place.run, "--listen", *endpoints.listen]
    if endpoints.connect:
        flags += ["--connect", *endpoints.connect]
    if place.secure is not None:
        flags += ["--secure", str(place.secure.absolute())]
    foreign = role == "planner" and options.planner_command is not None
    if options.inject_faults > 0.0 and not foreign:
        flags += ["--inject-faults", str(options.inject_faults), "--fault-seed", str(options.seed)]
    if options.record is not None and not foreign:
        flags += RECORDED
    return tuple(flags)


def flags_again(role: Role, options: RunOptions) -> tuple[str, ...]:
    """Return the flags that a restarted process needs besides `bus_flags`, since it may be recorded by then."""
    foreign = role == "planner" and options.planner_command is not None
    return () if foreign or options.record is not None else RECORDED
