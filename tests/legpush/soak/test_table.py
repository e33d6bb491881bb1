"""The table of faults has every cell once, and cells are found by name and by kind."""

from collections import Counter
from itertools import product

import pytest

from legpush.errors import ConfigError
from legpush.soak.table import KINDS, PHASES, ROLES, choose_cells, read_table

LEAST_CELLS = 108


def test_every_fault_for_every_role_in_every_phase_is_there_once() -> None:
    cells = Counter((cell.kind, cell.role, cell.phase) for cell in read_table())
    assert cells == Counter(product(KINDS, ROLES, PHASES))
    assert len(KINDS) >= 12
    assert len(choose_cells(())) >= LEAST_CELLS


def test_a_cell_without_sense_says_why_and_only_that_one_does() -> None:
    assert all((cell.expected == "none") == bool(cell.why) for cell in read_table())


def test_cells_are_chosen_by_name_and_by_kind_each_once() -> None:
    chosen = choose_cells(("kill-sim-walking", "kill", "drop-agent-pushing"))
    assert [cell.name for cell in chosen][:2] == ["kill-sim-walking", "kill-planner-planning"]
    assert len(chosen) == len(ROLES) * len(PHASES) + 1
    assert choose_cells(()) == tuple(cell for cell in read_table() if cell.expected != "none")


@pytest.mark.parametrize("name", ["kill-sim", "burn", "kill-launcher-walking", ""])
def test_a_cell_that_does_not_exist_is_refused_with_the_kinds(name: str) -> None:
    with pytest.raises(ConfigError, match=r"Expected a cell such as kill-planner-planning.*freeze_short"):
        choose_cells((name,))
