"""Seeds of starts by what they are for: what is chosen on some starts is judged on others."""

from collections.abc import Iterable, Mapping
from typing import Final

from legpush.errors import ConfigError

FIRST_CHECK_SEED: Final = 1_000_000
"""Starts by which a training chooses its best policy."""
FIRST_FINAL_SEED: Final = 2_000_000
"""Starts of the further evaluation of a training in a study."""
FIRST_SEARCH_SEED: Final = 4_000_000
"""Starts by which the best constant action is chosen."""


def require_held_out(seeds: Iterable[int], used: Mapping[str, Iterable[int]], flag: str) -> None:
    """Require starts on which nothing was chosen; `used` has the others, by what was chosen on them.

    Raises:
        ConfigError: A start was used before; names what for.
    """
    asked = set(seeds)
    for what, others in used.items():
        if both := sorted(asked.intersection(others)):
            raise ConfigError(
                f"Expected starts that nothing was chosen on for {flag}, got {len(both)}, such as {both[0]}, by which "
                f"{what} was chosen"
            )
