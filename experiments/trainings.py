"""`python -m experiments.trainings`: runs the trainings of all studies, several at a time, and collects their results.

Each training is one `legpush train` in a folder under `runs/trainings`. A complete training, in its folder or in the
results, is not run again; an interrupted one continues. Then the episodes of all trainings go to
`results/trainings_episodes.csv.gz`, and the check of each last policy goes to `results/trainings.csv`.
`python -m experiments.learning` draws them.
"""

import subprocess
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Literal

import tyro
from msgspec.structs import replace
from rich.console import Console
from rich.progress import Progress

from agent_proc.learning.training import CHECKPOINT_FILE, LAST
from agent_proc.policies.folder import CARD_FILE, Card, read_card
from agent_proc.profiles.profile import dump_profile, load_profile
from experiments.evaluations import RESULTS, read_table, write_table

EPISODES_FILE: Final = RESULTS / "trainings_episodes.csv.gz"
FINAL_FILE: Final = RESULTS / "trainings.csv"
SEEDS: Final = (1, 2, 3, 4, 5)
FEW_SEEDS: Final = SEEDS[:3]
NEAR_AND_FAR: Final = ("--distance-m", "0.1", "1.0")
RANDOMIZED: Final = (*NEAR_AND_FAR, "--mass-kg", "0.1", "2.0", "--friction", "0.3", "0.8")
CURVE_FLAGS: Final = {"tuned-fixed": ("--steps", "4096"), "tuned-variable": NEAR_AND_FAR}
"""Flags of each variant of the learning curves, besides the settings of its profile."""

Study = Literal["curves", "networks", "algorithms", "randomization"]
STUDIES: Final[tuple[Study, ...]] = ("curves", "networks", "algorithms", "randomization")


@dataclass(frozen=True, kw_only=True)
class Training:
    """One training."""

    study: Study
    variant: str
    """Name of the variant within its study."""
    seed: int
    profile: str = "tuned"
    entry: Literal["fixed", "variable"] = "variable"
    hidden: tuple[int, ...] | None = None
    """Widths of the networks; None for those of the profile."""
    n_simulators: int = 2
    flags: tuple[str, ...] = ()
    """Further flags of `legpush train`."""

    @property
    def name(self) -> str:
        """Name of its folder."""
        return f"{self.variant}-seed{self.seed}"


def trainings(studies: Iterable[Study]) -> list[Training]:
    """Return the trainings of these studies, seed by seed, so that an interruption leaves equal numbers of each."""
    return [training for study in studies for seed in SEEDS for training in _of_seed(study, seed)]


def _of_seed(study: Study, seed: int) -> list[Training]:
    match study:
        case "curves":
            return [
                Training(
                    study=study,
                    variant=f"{profile}-{entry}",
                    seed=seed,
                    profile=profile,
                    entry=entry,
                    n_simulators=1 if profile == "paper" else 2,
                    flags=CURVE_FLAGS.get(f"{profile}-{entry}", ()),
                )
                for profile in ("tuned", "paper")
                for entry in ("fixed", "variable")
            ]
        case "networks":
            sizes = ((512,) * 4, (128,) * 2, (64,) * 4) if seed in FEW_SEEDS else ()
            return [
                Training(
                    study=study,
                    variant=f"network-{len(hidden)}x{hidden[0]}",
                    seed=seed,
                    hidden=hidden,
                    flags=NEAR_AND_FAR,
                )
                for hidden in sizes
            ]
        case "algorithms":
            algorithms = ("sac", "td3") if seed in FEW_SEEDS else ()
            return [
                Training(study=study, variant=name, seed=seed, profile=name, flags=NEAR_AND_FAR) for name in algorithms
            ]
        case "randomization":
            flags = [RANDOMIZED] if seed in FEW_SEEDS else []
            return [Training(study=study, variant="randomized", seed=seed, flags=f) for f in flags]


@dataclass(frozen=True, kw_only=True)
class Config:
    """Which trainings to run, and where."""

    studies: Annotated[tuple[Study, ...], tyro.conf.arg(metavar="STUDY ...")] = STUDIES
    jobs: int = 2
    """How many trainings to run at once."""
    folder: Path = Path("runs/trainings")
    collect_only: bool = False
    """Run nothing; only collect the results of complete trainings."""
    again: bool = False
    """Also run trainings that are in the results, for example after the task changed; delete their folders first."""


def main(config: Config) -> int:
    """Run the missing trainings, then collect all results."""
    known = set() if config.again else {_name(row) for row in read_final()}
    planned = [t for t in trainings(config.studies) if t.name not in known and not config.collect_only]
    missing = [t for t in planned if not (config.folder / t.name / LAST).is_dir()]
    config.folder.mkdir(parents=True, exist_ok=True)
    console = Console()
    with Progress(console=console) as bar, ThreadPoolExecutor(config.jobs) as pool:
        task = bar.add_task("trainings", total=len(missing))
        futures = [pool.submit(_train, training, config.folder) for training in missing]
        try:
            for training, future in zip(missing, futures, strict=True):
                future.result()
                bar.advance(task)
                console.print(f"{training.name} is complete")
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    collect(trainings(STUDIES), config.folder)
    return 0


def _train(training: Training, folder: Path) -> None:
    """Run a training, or continue it.

    Raises:
        SystemExit: The training failed; the error has its last message.
    """
    out = folder / training.name
    if (out / CHECKPOINT_FILE).exists():
        arguments = ["--resume", str(out)]
    else:
        profile = training.profile
        if training.hidden is not None:
            loaded = load_profile(profile)
            path = folder / f"{training.variant}.toml"
            path.write_text(dump_profile(replace(loaded, network=replace(loaded.network, hidden=training.hidden))))
            profile = str(path)
        arguments = ["--profile", profile, "--entry", training.entry, "--seed", str(training.seed)]
        arguments += ["--simulators", str(training.n_simulators), "--out", str(out), *training.flags]
    command = [str(Path(sys.executable).with_name("legpush")), "train", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{training.name}: legpush train exited with {done.returncode}: {done.stderr.strip()}")


def collect(planned: Sequence[Training], folder: Path) -> None:
    """Write the results of complete trainings; rows of other trainings stay in the files."""
    here = {
        t.name: (t, read_card(folder / t.name / LAST)) for t in planned if (folder / t.name / LAST / CARD_FILE).exists()
    }
    episodes = [row for row in read_episodes() if _name(row) not in here]
    final = [row for row in read_final() if _name(row) not in here]
    for training, card in here.values():
        episodes += _episode_rows(training, card)
        final.append(_final_row(training, card))
    order = {t.name: index for index, t in enumerate(planned)}
    for rows in (episodes, final):
        rows.sort(key=lambda row: order[_name(row)])
    for rows, path in ((episodes, EPISODES_FILE), (final, FINAL_FILE)):
        if rows:
            write_table(rows, path)


def _name(row: dict[str, Any]) -> str:
    """Return the name of the training that a row belongs to."""
    return f"{row['variant']}-seed{row['seed']}"


def _episode_rows(training: Training, card: Card) -> list[dict[str, Any]]:
    return [
        {
            "study": training.study,
            "variant": training.variant,
            "seed": training.seed,
            "episode": index,
            "step": point.step,
            "return": round(point.episode_return, 4),
            "length": point.length,
            "success": int(point.success),
            "position_error_m": round(point.position_error_m, 5),
            "angle_error_deg": round(point.angle_error_deg, 4),
        }
        for index, point in enumerate(card.curve)
    ]


def _final_row(training: Training, card: Card) -> dict[str, Any]:
    check = card.check
    if check is None:
        raise SystemExit(f"{training.name}: expected the check of its last step on the card")
    return {
        "study": training.study,
        "variant": training.variant,
        "seed": training.seed,
        "steps": card.steps,
        "episodes": len(card.curve),
        "n_checked": len(check.seeds),
        "success_rate": check.success_rate,
        "position_error_m": round(check.position_error_m, 5),
        "angle_error_deg": round(check.angle_error_deg, 4),
        "cycles": round(check.cycles, 2),
        "falls": check.falls,
    }


def read_episodes() -> list[dict[str, Any]]:
    """Return every episode of the trainings in the file."""
    return [dict(row) for row in read_table(EPISODES_FILE)]


def read_final() -> list[dict[str, Any]]:
    """Return the final row of each training in the file."""
    return [dict(row) for row in read_table(FINAL_FILE)]


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Config)))
