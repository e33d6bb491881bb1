"""Checks a mission before a process is started or its folder is made: what cannot begin is refused at once."""

import os
import subprocess
from pathlib import Path
from typing import Final

from legpush.bus.secure.host_folder import credentials_of
from legpush.errors import DISK_FULL, ConfigError, LegpushError, OtherVersionError
from legpush.history.entries import Opened
from legpush.history.journal import cannot_go_on, read_entries
from legpush.launch.last_words import ERROR
from legpush.launch.process_commands import Place, Programs, agent_flags
from legpush.messages.common import ROLES
from legpush.numerics.computed_with import computed_with
from legpush.options.checks import require_writable_folder
from legpush.options.run import RunOptions
from legpush.policy_names import policy_kind
from legpush.processes.child import TAIL_LINES, describe_exit
from legpush.processes.environment import child_environment
from legpush.processes.start_program import Program, program_command
from legpush.runs.folder import SCENARIO_FILE, journals
from legpush.runs.reasons import REASONS
from legpush.runs.temporary import temporary_folder
from legpush.scenarios.file import dump_scenario, write_scenario
from legpush.scene.plan_settings import steering_fault
from legpush.scene.pushing.bounds import cannot_push
from legpush.scene.scenario import Scenario

CHECK: Final[Program] = "agent_proc.programs.check_mission"
"""Makes what a mission needs, as the agent does, and ends."""


def check_mission(options: RunOptions, scenario: Scenario, folder: Path, programs: Programs) -> None:
    """Check that the mission can begin.

    Raises:
        ConfigError: The folder cannot be written to, the robot cannot push the box, the planner cannot steer so, or the
            policy, the push map or the recording to continue cannot be used.
        CredentialsError: A certificate of --secure cannot be used.
        OtherVersionError: The folder has the mission of another version, whose scenarios were written otherwise.
        LegpushError: The check itself failed.
    """
    require_writable_folder(folder, "--out")
    for role in (*ROLES, "launcher", "recorder"):
        credentials_of(options.secure, role)
    _require_this_version(folder, scenario)
    if heavy := cannot_push(scenario):
        raise ConfigError(f"{scenario.name}: {heavy}; {REASONS['too_heavy'].remedy}")
    if options.planner_command is None and (fault := steering_fault(scenario.planning)):
        raise ConfigError(f"{fault} (`planning` of the scenario, --planner, --set)")
    if policy_kind(options.policy) == "own" and options.push_map is None and not programs.agent_flags:
        return
    with temporary_folder("check-") as scratch:
        write_scenario(scenario, scratch / SCENARIO_FILE)
        flags = agent_flags(options, Place(folder=scratch, sockets=scratch)) + programs.agent_flags
        done = subprocess.run(
            program_command(CHECK, flags),
            env=child_environment(os.environ),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
    if done.returncode == 0:
        return
    lines = [line for line in done.stderr.splitlines() if line.strip()]
    begin = next((index for index in reversed(range(len(lines))) if lines[index].startswith(ERROR)), None)
    if begin is not None and done.returncode in (ConfigError.exit_code, DISK_FULL):
        raise ConfigError(*(line[len(ERROR) :] for line in lines[begin:]))
    what = f"the check of the policy {options.policy} {describe_exit(done.returncode)}"
    raise LegpushError(f"{what}; its last lines:" if lines else what, *(f"    {line}" for line in lines[-TAIL_LINES:]))


def _require_this_version(folder: Path, scenario: Scenario) -> None:
    """Do nothing if the folder has the scenario as this version writes it, or was begun by this version."""
    file = folder / SCENARIO_FILE
    if not file.is_file() or file.read_bytes() == dump_scenario(scenario).encode():
        return
    for journal in journals(folder):
        opened = next(read_entries(journal), None)
        if isinstance(opened, Opened) and (other := computed_with(opened.versions).other_version()):
            raise OtherVersionError(f"{other}; {cannot_go_on(folder)}")
