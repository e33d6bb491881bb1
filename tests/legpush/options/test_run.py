"""Options of a run that cannot be used are refused with their flag."""

import pytest

from legpush.errors import ConfigError
from legpush.options.run import RunOptions


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"seed": -1}, "--seed, got -1"),
        ({"seed": 2**32}, "--seed, got 4294967296"),
        ({"inject_faults": 1.0}, "--inject-faults, got 1.0"),
        ({"inject_faults": float("nan")}, "--inject-faults, got nan"),
        ({"deadline_s": 0.0}, "--deadline, got 0.0"),
        ({"deadline_s": float("inf")}, "--deadline, got inf"),
    ],
)
def test_options_out_of_range_are_refused(options: dict[str, float], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        RunOptions(**options)  # type: ignore[arg-type]
