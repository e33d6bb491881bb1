"""Five trainings of `paper-learns`, the least change to the paper that learns, with a fixed entry (Fig. 14)."""

from experiments.rows import read_rows
from experiments.tables.parts import as_json, made_of
from experiments.tables.reproduction.summaries import training_numbers


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    study = read_rows("reproduction_learns_fixed")
    numbers = training_numbers(study.rows)
    episodes = numbers["episodes_to_90_percent"]
    found = numbers | {"fewest_episodes": min(episodes), "most_episodes": max(episodes)}
    return {"learns.json": as_json(made_of(reproduction_learns_fixed=study), {"fixed": found})}
