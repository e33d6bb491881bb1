"""A heavy box in a room where its path changes faces: it yields late, so short pushes do not move it."""

from pathlib import Path

import pytest

import legpush

ROOM = Path(__file__).with_name("heavy_room.toml")
"""Written by `legpush scenarios random heavy_room.toml --seed 7000003`."""


@pytest.mark.parametrize("mass_kg", [2.7, 5.0])
def test_a_heavy_box_is_brought_to_its_goal_over_several_faces(mass_kg: float) -> None:
    run = legpush.run(ROOM, seed=7000003, changes={"box.mass_kg": mass_kg})

    assert run.report.reason == "success", run.report.detail


@pytest.mark.parametrize("slope_deg", [5.0])
def test_a_box_is_pushed_uphill_until_it_is_there(slope_deg: float) -> None:
    run = legpush.run("push", seed=3, changes={"room.slope_deg": slope_deg})

    assert run.report.reason == "success", run.report.detail
    assert run.report.n_push_cycles < 60
