"""Ctrl-C at any instant ends every command without a traceback, with its exit code, and with nothing left behind.

By hand, `LEGPUSH_INSTANTS=10` tries ten instants of each command, and `LEGPUSH_SEED` repeats those of an earlier test.
"""

import os
from math import exp, log
from pathlib import Path
from random import Random
from signal import SIGINT
from typing import Final

import pytest

from tests.command_names import leaf_names
from tests.system.commands import COMMANDS, ENDLESS, RECORDING, RUN, STUDY, interrupt
from tests.system.conftest import RecordedMission

N_INSTANTS: Final = int(os.environ.get("LEGPUSH_INSTANTS", "1"))
SEED: Final = int(os.environ.get("LEGPUSH_SEED", Random().randrange(2**32)))
SOONEST_S: Final = 0.005
LATEST_S: Final = 4.0


def test_every_command_is_interrupted() -> None:
    begun = {" ".join(words) for words in COMMANDS.values()}
    # `python` is Python itself, and `kernel` writes one file.
    for name in set(leaf_names()) - {"python", "kernel"}:
        assert any(f"{words} ".startswith(f"{name} ") for words in begun), f"nothing interrupts legpush {name}"


@pytest.mark.parametrize("turn", range(N_INSTANTS))
@pytest.mark.parametrize("name", COMMANDS)
def test_an_interrupt_ends_a_command_without_a_traceback_and_without_remains(
    name: str, turn: int, tmp_path: Path, push_mission: RecordedMission, short_study: Path
) -> None:
    random = Random(f"{SEED} {name} {turn}")
    while_loading = exp(random.uniform(log(SOONEST_S), log(LATEST_S)))
    after_s = random.choice((while_loading, random.uniform(SOONEST_S, LATEST_S)))
    words = {RECORDING: str(push_mission.file), RUN: str(push_mission.out), STUDY: str(short_study)}
    ended = interrupt(name, after_s, tmp_path, words)

    what = f"{name} after {after_s:.3f} s, LEGPUSH_SEED={SEED}, exit code {ended.exit_code}:\n{ended.output}"
    assert "Traceback" not in ended.output, what
    assert "Exception ignored" not in ended.output, what
    assert ended.left == (), f"{ended.left} {what}"
    # In the last milliseconds of Python a signal ends it as such, which a shell calls 130 as well.
    codes = (130, 0, -SIGINT, *ENDLESS.get(name, ())) if ended.was_running else (0,)
    assert ended.exit_code in codes, what
