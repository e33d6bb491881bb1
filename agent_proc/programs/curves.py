"""Learning curves as a program: `legpush curves`."""

import numpy as np
from rich.console import Console
from rich.text import Text

from agent_proc.policies.card import Card
from agent_proc.statistics.estimate import CUT
from agent_proc.statistics.intervals import STUDENT_T
from agent_proc.studies.comparison.contestants import Contestant, cards_of, find_contestants
from agent_proc.studies.comparison.curves import MEASURES, TITLES, WINDOW, Curve, make_curve, save_curves
from legpush.errors import ConfigError
from legpush.options.checks import require_new_file
from legpush.options.learning_tools import CurvesOptions
from legpush.output.reply import document
from legpush.service import run_command


def main() -> int:
    """Parse the command line and draw the curves; returns the exit code."""
    return run_command("curves", CurvesOptions, lambda options: draw_curves(options, Console()))


def draw_curves(options: CurvesOptions, console: Console) -> int:
    """Draw the curves of all trainings, and print where they end; returns the exit code.

    Raises:
        ConfigError: A training is not done or has too few episodes, or the file exists.
        PolicyError: A RUN is no training and no policy folder.
    """
    require_new_file(options.out, "--out")
    trainings = [each for each in find_contestants(options.runs, "last") if not each.is_rival]
    curves = [make_curve(each.label, [card.curve for card in _cards(each)]) for each in trainings]
    save_curves(curves, options.out)
    for curve in curves:
        console.print(Text(f"{curve.label}: {_end(curve)}"), soft_wrap=True)
    said = f"means over the last {WINDOW} episodes of the trainings, with exploration; {STUDENT_T}, {CUT}"
    console.print(Text(said), soft_wrap=True)
    console.print(Text(f"wrote {options.out}"), soft_wrap=True)
    document({"picture": options.out, "curves": [_plain(curve) for curve in curves]})
    return 0


def _cards(contestant: Contestant) -> list[Card]:
    cards = cards_of([contestant])
    if len(cards) < len(contestant.policies):
        raise ConfigError(f"Expected trainings or policy folders, got {contestant.label}, which has no episodes")
    return cards


def _end(curve: Curve) -> str:
    """The last values of the curves, with their intervals over the seeds."""
    parts: list[str] = []
    for name in MEASURES:
        title, scale = TITLES[name]
        parts.append(f"{title} {curve.end(name).scaled(scale):.2f}")
    n = len(next(iter(curve.seeds.values())))
    return f"{', '.join(parts)} (n {n}, step {curve.steps[-1]:.0f})"


def _plain(curve: Curve) -> dict[str, object]:
    seeds = {name: np.round(values, 6) for name, values in curve.seeds.items()}
    return {"label": curve.label, "step": curve.steps, "seeds": seeds}
