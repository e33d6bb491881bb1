"""The agent as a process: runs a mission, or the rest of one, and writes its report and picture."""

import logging
import os
import shlex
import sys
import threading
from dataclasses import dataclass
from pathlib import Path
from time import time
from typing import Annotated, Final

from agent_proc.mission.branching import Branch, BranchPolicy, read_branch
from agent_proc.mission.facts import JSON, attach_facts
from agent_proc.mission.mission import run_mission
from agent_proc.mission.progress import MissionProgress
from agent_proc.policies.learned import require_single_face
from agent_proc.policies.policy import Policy
from agent_proc.policies.registry import make_policy, policy_from_data
from agent_proc.push_model.map import PushMap, load_push_map
from agent_proc.reporting.report import Begun
from agent_proc.reporting.report_files import write_report
from agent_proc.walking.actor import as_it_is
from legpush.arguments import Flag, Switch, arg
from legpush.bounds import BoxMass, Friction, WaitS
from legpush.bus.bus import Bus
from legpush.bus.endpoints import DEFAULT_NAME
from legpush.bus.status import StatusBeacon
from legpush.errors import ConfigError
from legpush.fields import Name, Seed, require
from legpush.files import make_folder
from legpush.history.entries import Opened
from legpush.history.journal import Journal
from legpush.lockstep.client import SimLink
from legpush.lockstep.episode import Episode
from legpush.messages.common import PROTOCOL_VERSION
from legpush.messages.stepping import Alter
from legpush.patience import Patience
from legpush.plans.client import PlanLink
from legpush.policy_names import DEFAULT_POLICY
from legpush.recording.branch import parse_point
from legpush.runs.folder import REPORT_FILE, require_no_links
from legpush.scenarios.file import load_scenario
from legpush.scene.names import PlannerName
from legpush.scene.scenario import Scenario
from legpush.service import ServiceConfig, run_process
from legpush.versions import installed_versions

log = logging.getLogger(__name__)

JOURNAL_FILE: Final = "episode-0000.journal"


@dataclass(frozen=True, kw_only=True)
class AgentConfig(ServiceConfig):
    """Run a mission. Exit codes: 0 the box is at its goal, 1 it is not, 2 bad input, 3 a peer failed, 5 disk full.

    Environment: LEGPUSH_RUN, LEGPUSH_LISTEN, LEGPUSH_CONNECT (endpoints by commas).
    """

    scenario: Annotated[str, arg("NAME|FILE")] = "default"
    """A built-in scenario or the path of a scenario file."""
    seed: Annotated[int, arg("N")] = 0
    """Draws the offsets of start and box, and seeds the planner."""
    out: Annotated[Path | None, arg("DIR")] = None
    """Folder of journal, report and picture, `runs/<scenario>-seed<N>` if not given. An interrupted mission goes on
    there."""
    policy: Annotated[str, arg("POLICY")] = DEFAULT_POLICY
    """What chooses the pushes: scripted, the name of a shipped policy, a policy folder, a model file (.zip), or
    module:factory."""
    trust_policy_file: Flag = False
    """Load model files (.zip): they are pickles, and loading one runs any code in it."""
    recorded_policy_sha256: Annotated[str | None, arg("HEX")] = None
    """The policy is named by a recording and must have this SHA-256; it runs no code unless --repeated-policy names
    it."""
    repeated_policy: Annotated[str | None, arg("POLICY")] = None
    """The policy of a recording that runs code, repeated by the user, who trusts it."""
    push_map: Annotated[Path | None, arg("FILE")] = None
    """What pushes do to this box, as `legpush calibrate` measured it; else what they do to the default one, scaled."""
    branch_of: Annotated[tuple[Path, ...], arg("FILE ...")] = ()
    """Continue the mission of this recording. Scenario, seed and push map have to be those of the recording."""
    branch_at: Annotated[str, arg("EPISODE:STEP")] = ""
    """First step that is not repeated from the recording."""
    branch_planner: Annotated[PlannerName | None, arg()] = None
    """Planner from that step on, instead of the scenario's."""
    branch_box_mass_kg: Annotated[float | None, arg("KG")] = None
    """Mass of the box from that step on; the mission does not know it."""
    branch_box_friction: Annotated[float | None, arg("MU")] = None
    """Friction of box and floor from that step on; the mission does not know it."""
    branch_box_foot_friction: Annotated[float | None, arg("MU")] = None
    """Friction of box and foot from that step on; the mission does not know it."""
    planner_command: Annotated[str | None, arg("COMMAND")] = None
    """For the report: the command of the planner, if it is not that of this package."""
    command: Annotated[str | None, arg("COMMAND")] = None
    """For the report: the command that began the mission; that of this process if not given."""
    witness_planner: Flag = False
    """Hand the planner's answers to recorders as well, for a planner that does not do that itself."""
    picture: Switch = True
    """Draw mission.png at the end."""
    sim: Annotated[str, arg("NAME")] = DEFAULT_NAME
    """Name of the simulator."""
    deadline_s: Annotated[float, arg("S", name="deadline")] = 60.0
    """Give up on a peer that does not answer within this time."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require(Name, self.sim, "--sim")
        require(Seed, self.seed, "--seed")
        require(WaitS, self.deadline_s, "--deadline", "seconds")
        require(BoxMass, self.branch_box_mass_kg, "--branch-box-mass-kg")
        require(Friction, self.branch_box_friction, "--branch-box-friction")
        require(Friction, self.branch_box_foot_friction, "--branch-box-foot-friction")

    def branch(self) -> Branch | None:
        """The recorded mission to continue, or None.

        Raises:
            RecordingError: It cannot be continued at that step.
        """
        if not self.branch_of:
            return None
        changed = Alter(
            box_mass_kg=self.branch_box_mass_kg,
            box_friction=self.branch_box_friction,
            box_foot_friction=self.branch_box_foot_friction,
        )
        alter = None if changed == Alter() else changed
        return read_branch(
            self.branch_of,
            parse_point(self.branch_at),
            repeated_policy=self.repeated_policy,
            trust_file=self.trust_policy_file,
            planner=self.branch_planner,
            alter=alter,
        )

    def begun(self) -> Begun:
        """Return how the mission was begun."""
        own = shlex.join(["python", "-m", "agent_proc", *sys.argv[1:]])
        return Begun(policy=self.policy, planner=self.planner_command, command=self.command or own)

    def make_policy(self) -> Policy:
        """The policy of the mission.

        Raises:
            PolicyError: There is no such policy, it cannot be used, or a recording must not choose it.
        """
        trust_file = self.trust_policy_file
        if self.recorded_policy_sha256 is None:
            return make_policy(self.policy, trust_file=trust_file)
        sha256, repeated = self.recorded_policy_sha256, self.repeated_policy
        return policy_from_data(self.policy, sha256, repeated=repeated, trust_file=trust_file)


def read_inputs(config: AgentConfig) -> tuple[Scenario, Policy, PushMap | None, Branch | None]:
    """Read and make what the mission of `config` needs, before any other process is asked.

    Raises:
        LegpushError: Scenario, policy, push map or branch cannot be used.
    """
    scenario = load_scenario(config.scenario)
    push_map = None if config.push_map is None else load_push_map(config.push_map, scenario.box)
    policy = config.make_policy()
    require_single_face(policy)
    return scenario, policy, push_map, config.branch()


def work(config: AgentConfig, bus: Bus, stop: threading.Event) -> int:
    """Run the mission of `config`; return 0 if the box is at its goal, else 1.

    Raises:
        LegpushError: What ended the mission, if it was no outcome of the mission itself; its report is written.
    """
    scenario, policy, push_map, branch = read_inputs(config)
    usual = Path("runs") / f"{scenario.name}-seed{config.seed}"
    folder = writable_folder(config.out or usual, private=config.out is None)
    opened = Opened(
        protocol=PROTOCOL_VERSION,
        run=bus.run,
        seed=config.seed,
        versions={name: version for name, version in installed_versions().items() if version is not None},
        began_unix_s=time(),
    )
    with Journal(folder / JOURNAL_FILE, opened) as journal, StatusBeacon(bus, "starting") as beacon:
        if config.witness_planner:
            bus.taps.witness_role("planner")
        attach_facts(bus, scenario, config.seed, config.policy, config.push_map, opened.versions)
        patience = Patience(deadline_s=config.deadline_s)
        progress = MissionProgress(beacon)
        episode = Episode(
            journal,
            SimLink(bus, config.sim, stop=stop, patience=patience, on_wait=progress.wait),
            PlanLink(bus, stop=stop, patience=patience, on_wait=progress.wait),
            None if branch is None else branch.past,
        )
        if branch is not None:
            policy = BranchPolicy(branch.past_policy, policy, lambda: branch.is_past(episode.n_steps))
        bus.announce()
        result = run_mission(
            episode,
            scenario,
            config.seed,
            policy,
            push_map,
            as_it_is if branch is None else lambda whole: branch.scenario(whole, episode.n_steps),
            progress.tell,
        )
        beacon.publish_status("reporting", None, result.detail)
        if not episode.live:
            log.info("the mission in %s was over before: only its report is written again", folder)
        write_report(folder, journal, result, config.begun(), picture=config.picture)
        bus.attach(REPORT_FILE, JSON, (folder / REPORT_FILE).read_bytes())
        if result.error is not None:
            raise result.error
    log.info("%s: %s; see %s", result.reason, result.detail, folder)
    return 0 if result.success else 1


def main() -> int:
    """Run the process; returns the exit code."""
    return run_process("agent", AgentConfig, work)


def writable_folder(folder: Path, *, private: bool) -> Path:
    """Make the folder if need be, and return it; only the user can enter a new one that is `private`.

    Raises:
        ConfigError: It cannot be made, nothing can be written to it, or there is a link in it.
    """
    try:
        make_folder(folder, private=private)
    except OSError as error:
        raise ConfigError(f"Expected a folder that can be made for --out, got {folder} ({error.strerror})") from error
    if not os.access(folder, os.W_OK | os.X_OK):
        raise ConfigError(f"Expected a folder that can be written to for --out, got {folder}")
    require_no_links(folder)
    return folder
