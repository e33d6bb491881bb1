"""The levels of the benchmark: every rival and every learned policy from the same starts of each level."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import isfinite, nan
from typing import Any, Final

from agent_proc.figures import Axes, Figure
from agent_proc.statistics.intervals import share
from agent_proc.studies.comparison.contestants import Contestant
from agent_proc.studies.comparison.outcome import LOSS, THRESHOLDS, Entry, Versus, make_outcome
from agent_proc.task.file import load_task
from experiments.rows import Made, Row, has_rows, read_rows
from experiments.tables.parts import as_csv, as_json, plain
from legpush.options.learning_tools import FIRST_HELD_OUT_SEED
from legpush.scene.scenario import Goal

LEVELS: Final = {"l0": "tuned", "l1": "push-l1", "l2": "push-l2", "l3": "push-l3"}
"""The tasks of the levels."""
TABLES: Final = {**LEVELS, "l1_physics": "push-l1"}
"""The tasks of the tables: level 1 has a second one, in the simulator."""
EPISODES: Final = ("level_{}", "level_{}_oracle", "level_{}_informed")
"""Studies of a level whose rows are episodes."""
TRAININGS: Final = ("level_{}_learned", "level_{}_sac", "level_{}_default_box", "level_{}_recurrent")
"""Studies of a level whose rows are trainings, with an episode from each of the same starts."""
TURNS: Final = "level_{}_turns"
"""The study of a level whose rows say which way its boxes can be turned."""
LEAST_TURN_DEG: Final = 0.5
"""A box turns to a side if some push turns it there by this much."""
ORACLE: Final = "look_ahead_by_physics"
INFORMED: Final = "informed"
NO_RIVALS: Final = (ORACLE, INFORMED, "variable")
"""Not the best rival: oracles know what no policy knows, and the shipped policy was learned."""
COLUMNS: Final = (
    "level",
    "policy",
    "seed",
    "ending",
    "success",
    "position_error_m",
    "angle_error_deg",
    "n_cycles",
    "simulated_s",
    "decision_cpu_s",
)
N_DIGITS: Final = 7
LEARNERS: Final = {"tuned": "ppo", "sac": "sac", "td3": "td3", None: "recurrent_ppo"}
"""The learners by the profiles of their trainings; the recurrent one has none."""
OF_DEFAULT_BOX: Final = "ppo_default_box"
"""PPO whose trainings had other starts than those it is judged from: with the default box."""
OF_SEED: Final = " of seed "
"""Between the name of a learner and the seed of one of its trainings."""
STYLES: Final[Mapping[str, tuple[str, str]]] = {
    "zero": ("0.65", ":"),
    "random": ("0.65", "-."),
    "constant": ("0.35", "--"),
    "alternate": ("0.65", "--"),
    "bang_bang": ("0.35", "-."),
    "script": ("#E69F00", "-"),
    "script_over_map": ("#E69F00", "--"),
    "look_ahead": ("#56B4E9", "-"),
    ORACLE: ("#56B4E9", ":"),
    "search": ("#009E73", "-"),
    "dynamic_programming": ("#0072B2", "-"),
    INFORMED: ("#0072B2", ":"),
    "variable": ("#CC79A7", "-"),
    "ppo": ("#D55E00", "-"),
    OF_DEFAULT_BOX: ("#CC79A7", "--"),
    "recurrent_ppo": ("#D55E00", "--"),
    "sac": ("#D55E00", "-."),
    "td3": ("#D55E00", ":"),
}
"""Colour and line of each policy: grey for those that see little or nothing, else the colours of Okabe and Ito."""


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    made: dict[str, Made] = {}
    numbers: dict[str, Any] = {}
    episodes: list[Row] = []
    for level, task in TABLES.items():
        if rows := _read(level, made):
            numbers[level] = {**numbers_of(rows, load_task(task).scenario.goal), **_turns(level, made)}
            episodes += [{"level": level, **{name: row[name] for name in COLUMNS[1:]}} for row in rows]
    return {"levels.csv": as_csv(episodes), "levels.json": as_json(made, numbers)}


def pictures() -> dict[str, Figure]:
    """Draw a panel for each level: the share of its starts from which a policy has at most a given loss."""
    figure = Figure(figsize=(11.0, 8.6), layout="constrained", dpi=110)
    for axis, (level, task) in zip(figure.subplots(2, 2, sharex=True, sharey=True).flat, LEVELS.items(), strict=True):
        rows = _read(level, {})
        goal = load_task(task).scenario.goal
        _draw(axis, {each.label: _entry(rows, each, goal) for each in _contestants(rows)})
        axis.set_title(f"{level.upper()}, {task}: {_n_starts(rows)} starts")
    for axis in figure.axes[2:]:
        axis.set_xlabel("loss: the larger error, in tolerances of 3 cm and 3°")
    drawn = {line.get_label(): line for axis in figure.axes for line in axis.lines}
    shown = {name: drawn[name] for name in STYLES if name in drawn}
    figure.legend(shown.values(), shown.keys(), loc="outside lower center", ncols=5)
    figure.suptitle("Share of starts with at most this loss; at 1 it is the share of successes")
    return {"levels.png": figure}


def _draw(axis: Axes, entries: Mapping[str, Entry]) -> None:
    for label, entry in entries.items():
        colour, line = STYLES[label]
        shares = [100.0 * each.value for each in entry.loss_profile]
        axis.plot(THRESHOLDS, shares, color=colour, linestyle=line, linewidth=1.8, label=label)
    axis.axvline(1.0, color="black", linewidth=0.8, zorder=0)
    axis.set_xscale("log")
    axis.set_xlim(0.03, THRESHOLDS[-1])
    axis.set_xticks([0.1, 1.0], ["0.1", "1"])
    axis.set_ylim(-2.0, 102.0)
    axis.set_ylabel("share of starts [%]")
    axis.grid(alpha=0.3)
    axis.label_outer()


def _turns(level: str, made: dict[str, Made]) -> dict[str, int]:
    """Which way the boxes of a level turn, if that was kept; `made` gets how it was made."""
    name = TURNS.format(level)
    if not has_rows(name):
        return {}
    study = read_rows(name)
    made[name] = study.made
    return turns_of(study.rows)


def turns_of(rows: Sequence[Row]) -> dict[str, int]:
    """How many boxes there are, and how many of them some push turns to the left and another one to the right."""
    both = [min(row["turn_deg"]) < -LEAST_TURN_DEG and max(row["turn_deg"]) > LEAST_TURN_DEG for row in rows]
    return {"n_turned": len(both), "n_turned_both_ways": sum(both)}


def _read(level: str, made: dict[str, Made]) -> list[Row]:
    """The episodes of all studies of a level that have been kept; `made` gets how they were made."""
    rows: list[Row] = []
    for names, as_episodes in ((EPISODES, list), (TRAININGS, episodes_of)):
        for name in (each.format(level) for each in names):
            if has_rows(name):
                study = read_rows(name)
                made[name] = study.made
                rows += as_episodes(study.rows)
    return rows


def episodes_of(trainings: Sequence[Row]) -> list[Row]:
    """A row for each start from which the last policy of a training was judged; `policy` ends with its seed."""
    return [
        {
            "policy": f"{_learner(training)}{OF_SEED}{training['seed']}",
            "seed": FIRST_HELD_OUT_SEED + start,
            "ending": ending,
            "success": training["final_success"][start],
            "position_error_m": training["final_position_error_m"][start],
            "angle_error_deg": training["final_angle_error_deg"][start],
            "n_cycles": training["final_n_cycles"][start],
            "simulated_s": training["final_simulated_s"][start],
            "decision_cpu_s": nan,
        }
        for training in trainings
        for start, ending in enumerate(training["final_ended"])
    ]


def _learner(training: Row) -> str:
    return OF_DEFAULT_BOX if training.get("starts") is not None else LEARNERS[training.get("profile")]


def numbers_of(rows: Sequence[Row], goal: Goal) -> dict[str, Any]:
    """Numbers of every policy on its starts, and what it has less than the best rival on the starts of both.

    A start is solved if any policy succeeded from it: of the others nobody knows whether they can be.
    """
    contestants = {each.label: each for each in _contestants(rows)}
    entries = {label: _entry(rows, each, goal) for label, each in contestants.items()}
    best = contestants[_best_rival(list(entries.values()))]
    return {
        "n": _n_starts(rows),
        "n_solved": _n_starts([row for row in rows if row["success"]]),
        "best_rival": best.label,
        "policies": {
            label: {**_of_entry(entry), "endings": _endings(rows, contestants[label])}
            for label, entry in entries.items()
        },
        "minus_best_rival": {
            label: _of_versus(_versus(rows, each, best, goal))
            for label, each in contestants.items()
            if label != best.label
        },
    }


def _contestants(rows: Sequence[Row]) -> list[Contestant]:
    """The rivals by their names, and the trainings of each learner."""
    policies: dict[str, list[str]] = {}
    for policy in dict.fromkeys(row["policy"] for row in rows):
        policies.setdefault(policy.partition(OF_SEED)[0], []).append(policy)
    return [
        Contestant(label=label, policies=tuple(found), is_rival=OF_SEED not in found[0])
        for label, found in policies.items()
    ]


def _n_starts(rows: Sequence[Row]) -> int:
    return len({row["seed"] for row in rows})


def _entry(rows: Sequence[Row], contestant: Contestant, goal: Goal) -> Entry:
    """Numbers of a contestant on its own starts; those of an oracle are the first ones of the others."""
    own = [row for row in rows if row["policy"] in contestant.policies]
    return make_outcome(own, [contestant], contestant.label, (), [], goal).entries[0]


def _versus(rows: Sequence[Row], contestant: Contestant, best: Contestant, goal: Goal) -> Versus:
    """Differences from the best one, on the starts that both have."""
    starts = [{row["seed"] for row in rows if row["policy"] in each.policies} for each in (contestant, best)]
    both = [row for row in rows if row["seed"] in starts[0] & starts[1]]
    return make_outcome(both, [contestant, best], best.label, (), [], goal).versus[0]


def _best_rival(entries: Sequence[Entry]) -> str:
    """The policy without learning, and without an oracle, that has the most successes, and then the least loss."""
    rivals = [entry for entry in entries if entry.is_rival and entry.label not in NO_RIVALS]
    best = max(rivals, key=lambda entry: (entry.means["success"].value, -entry.means[LOSS].value))
    return best.label


def _of_entry(entry: Entry) -> dict[str, Any]:
    means = dict(entry.means)
    if entry.n_trainings == 1:
        # A share of independent starts, as on all pages.
        means["success"] = share(round(means["success"].value * entry.n_starts), entry.n_starts)
    return {
        "n_trainings": entry.n_trainings,
        "n_starts": entry.n_starts,
        **{name: plain(mean, N_DIGITS) for name, mean in means.items() if isfinite(mean.value)},
        "loss_iqm": plain(entry.loss_iqm, N_DIGITS),
    }


def _endings(rows: Sequence[Row], contestant: Contestant) -> dict[str, int]:
    """How many episodes ended in which way, the most frequent one first."""
    counts = Counter(row["ending"] for row in rows if row["policy"] in contestant.policies)
    return dict(counts.most_common())


def _of_versus(versus: Versus) -> dict[str, Any]:
    return {
        **{name: plain(difference, N_DIGITS) for name, difference in versus.differences.items()},
        "probability_of_lower_loss": asdict(versus.improvement.rounded(4)),
    }
