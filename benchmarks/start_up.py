"""`python -m benchmarks.start_up`: how soon a mission moves, what its agent holds in memory, and what a decision costs.

A mission is a whole `legpush run` without picture and film. With `--against CHECKOUT`, the same missions are run with
the source of another checkout as well, in turn. A decision is timed with NumPy, as missions make it, and with the same
weights in Stable-Baselines3.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Final

import numpy as np
import psutil
import torch
import tyro
from stable_baselines3.common.utils import ConstantSchedule
from stable_baselines3.ppo import MlpPolicy

from agent_proc.policies.folder import policy_path, read_policy
from agent_proc.policies.sb3.arguments import policy_arguments, use_one_thread
from agent_proc.policies.sb3.spaces import action_space, observation_space
from benchmarks.report import write_report
from legpush.errors import JournalError
from legpush.history.entries import Acted
from legpush.history.journal import read_entries
from legpush.messages.stepping import Reset

CHECKOUT: Final = Path(__file__).parents[1]
LEGPUSH: Final = "import sys; from legpush.cli import main; sys.exit(main())"
POLL_S: Final = 0.005
N_DECISIONS: Final = 5000
IMPORT: Final = """
import time
began = time.perf_counter()
import agent_proc.mission.process
print(time.perf_counter() - began)
"""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    scenario: str = "push"
    """The mission."""
    n_runs: int = 5
    """Number of missions, with seeds from 0."""
    against: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    """Another checkout to compare with."""
    label: str = "other"
    """What the other checkout is called in the results."""


@dataclass(frozen=True, kw_only=True)
class Mission:
    """One `legpush run`."""

    first_motion_s: float
    """From the start of the command to the first motion that the agent asks for."""
    wall_s: float
    """Of the whole command."""
    cpu_s: float
    """Of the command and its children."""
    agent_mb: float
    """Largest resident memory of the agent."""
    agent_import_s: float
    """Time in which a fresh interpreter imports the modules of the agent."""
    state_crc: str


def main(config: Config) -> None:
    """Measure, print, and write the numbers."""
    checkouts = {"this": CHECKOUT} | ({} if config.against is None else {config.label: config.against.resolve()})
    load = os.getloadavg()[0]
    missions: dict[str, list[Mission]] = {name: [] for name in checkouts}
    for seed in range(config.n_runs):
        for name, checkout in checkouts.items():
            missions[name].append(mission := measure(checkout, config.scenario, seed))
            print(f"seed {seed}, {name}: {mission}", flush=True)
    medians = {
        name: {
            field: float(np.median([getattr(mission, field) for mission in measured]))
            for field in ("first_motion_s", "wall_s", "cpu_s", "agent_mb", "agent_import_s")
        }
        for name, measured in missions.items()
    }
    decision_us = decisions()
    print(f"medians: {medians}; one decision, us: {decision_us}")
    write_report(
        "start_up",
        {
            "load_before": load,
            "medians": medians,
            "decision_us": decision_us,
            "missions": {name: [asdict(mission) for mission in measured] for name, measured in missions.items()},
        },
    )


def measure(checkout: Path, scenario: str, seed: int) -> Mission:
    """Run one mission with the source of a checkout."""
    environment = {**os.environ, "PYTHONPATH": f"{checkout / 'shared'}{os.pathsep}{checkout}"}
    with tempfile.TemporaryDirectory(prefix="legpush-start-up-") as temporary:
        folder = Path(temporary) / "run"
        argv = [sys.executable, "-P", "-c", LEGPUSH, "run", scenario, "--seed", str(seed)]
        argv += ["--no-video", "--no-picture", "--out", str(folder)]
        before_s, began_s = _cpu_of_children_s(), time.perf_counter()
        process = psutil.Popen(
            argv, env=environment, cwd=temporary, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        first_motion_s, agent_mb, size = None, 0.0, 0
        while process.poll() is None:
            journal = folder / "episode-0000.journal"
            if first_motion_s is None and journal.exists() and journal.stat().st_size > size:
                size = journal.stat().st_size
                if _has_moved(journal):
                    first_motion_s = time.perf_counter() - began_s
            agent_mb = max(agent_mb, _agent_mb(process))
            time.sleep(POLL_S)
        wall_s, cpu_s = time.perf_counter() - began_s, _cpu_of_children_s() - before_s
        report = json.loads((folder / "report.json").read_bytes())
        if first_motion_s is None:
            raise RuntimeError(f"Nothing moved in the mission {scenario} with seed {seed}")
        imported = subprocess.run(
            [sys.executable, "-P", "-c", IMPORT],
            env=environment,
            cwd=temporary,
            check=True,
            capture_output=True,
            text=True,
        )
    return Mission(
        first_motion_s=first_motion_s,
        wall_s=wall_s,
        cpu_s=cpu_s,
        agent_mb=agent_mb,
        agent_import_s=float(imported.stdout),
        state_crc=report["state_crc"],
    )


def decisions() -> dict[str, float]:
    """Microseconds of the network for one observation, with each library."""
    policy = read_policy(policy_path("variable"))
    task, actor = policy.card.task, policy.actor()
    use_one_thread()
    networks = MlpPolicy(
        observation_space(task), action_space(task), ConstantSchedule(0.0), **policy_arguments(policy.card.profile)
    )
    linear = [module for module in networks.mlp_extractor.policy_net if isinstance(module, torch.nn.Linear)]
    for module, layer in zip([*linear, networks.action_net], actor.layers, strict=True):
        module.load_state_dict({"weight": torch.from_numpy(layer.weight), "bias": torch.from_numpy(layer.bias)})
    seen = np.linspace(-1.0, 1.0, len(actor.layers[0].weight[0]), dtype=np.float32)
    done, expected = actor.act(seen), networks.predict(seen, deterministic=True)[0]
    if not np.allclose(done, expected, rtol=0.0, atol=1e-6):
        raise RuntimeError(f"NumPy gives {done}, Stable-Baselines3 {expected}")
    return {
        "numpy": _microseconds(lambda: actor.act(seen)),
        "stable_baselines3": _microseconds(lambda: networks.predict(seen, deterministic=True)),
    }


def _microseconds(decide: Callable[[], object]) -> float:
    """Median time of a decision."""
    times = []
    for _ in range(N_DECISIONS):
        began = time.perf_counter()
        decide()
        times.append(time.perf_counter() - began)
    return 1e6 * float(np.median(times))


def _has_moved(journal: Path) -> bool:
    try:
        return any(isinstance(entry, Acted) and not isinstance(entry.motion, Reset) for entry in read_entries(journal))
    except JournalError:
        return False


def _agent_mb(launcher: psutil.Popen) -> float:
    """Resident memory of the agent; 0 if it does not run."""
    try:
        agents = [child for child in launcher.children() if "agent_proc" in child.cmdline()]
        return max((child.memory_info().rss / 1e6 for child in agents), default=0.0)
    except psutil.Error:
        return 0.0


def _cpu_of_children_s() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main(tyro.cli(Config))
