"""What an evaluation varies."""

import pytest
from msgspec.structs import replace

from agent_proc.evaluation.sweep import make_sweep
from legpush.errors import ConfigError, ScenarioError
from legpush.scene.scenario import PoseDeg
from legpush.scene.station import station
from tests.agent.fake_world import scenario_at_station
from tests.robots import ROBOT


def test_a_sweep_changes_one_field_at_a_time_and_a_grid_all_of_them() -> None:
    sweeps = ["box.mass_kg=0.1,0.5", "box.friction=0.3,0.8"]

    assert list(make_sweep(scenario_at_station(), sweeps, grid=False).cases) == [
        "box.mass_kg=0.1",
        "box.mass_kg=0.5",
        "box.friction=0.3",
        "box.friction=0.8",
    ]
    grid = make_sweep(scenario_at_station(), sweeps, grid=True)
    assert len(grid.cases) == 4
    case = "box.mass_kg=0.5 box.friction=0.3"
    assert (grid.cases[case].box.mass_kg, grid.cases[case].box.friction) == (0.5, 0.3)
    assert grid.columns(case) == {"box.mass_kg": 0.5, "box.friction": 0.3}
    assert make_sweep(scenario_at_station(), [], grid=True).cases == {"": scenario_at_station()}


def test_shape_size_and_slope_can_be_swept() -> None:
    scenario = scenario_at_station()

    sweep = make_sweep(
        scenario, ["box.shape=cuboid,l_shape", "box.size_m=0.3x0.5x0.4,0.6x0.4x0.4", "room.slope_deg=5"], grid=True
    )

    assert len(sweep.cases) == 4
    oblong = sweep.cases["box.shape=l_shape box.size_m=0.6x0.4x0.4 room.slope_deg=5.0"]
    assert (oblong.box.shape, oblong.box.size_m, oblong.room.slope_deg) == ("l_shape", (0.6, 0.4, 0.4), 5.0)
    assert oblong.start.pose() == station(ROBOT, oblong.box, oblong.box.pose.pose())
    assert oblong.start.x_m == pytest.approx(scenario.start.x_m - 0.1)


def test_numbers_of_the_robot_can_be_swept() -> None:
    sweep = make_sweep(scenario_at_station(), ["robot.pushing.gap_m=0.1,0.2", "robot.gait.stride_m=0.3"], grid=True)

    wide = sweep.cases["robot.pushing.gap_m=0.2 robot.gait.stride_m=0.3"]
    assert (wide.robot.pushing.gap_m, wide.robot.gait.stride_m) == (0.2, 0.3)
    assert wide.robot.legs == ROBOT.legs
    assert wide.start.pose() == station(wide.robot, wide.box, wide.box.pose.pose())


def test_a_robot_that_starts_elsewhere_stays_there_whatever_the_size() -> None:
    scenario = replace(scenario_at_station(), start=PoseDeg(x_m=2.0, y_m=3.0, yaw_deg=0.0))

    (case,) = make_sweep(scenario, ["box.size_m=0.8x0.4x0.4"], grid=False).cases.values()

    assert case.start == scenario.start


@pytest.mark.parametrize(
    ("sweeps", "error", "message"),
    [
        (["box.mass_kg"], ConfigError, r"FIELD=VALUE,VALUE,\.\.\. for --sweep.*got 'box.mass_kg'"),
        (["box.mass_kg=0.1,,2"], ConfigError, "FIELD=VALUE"),
        (["box.mass_kg=-1"], ScenarioError, "box.mass_kg"),
        (["box.colour=1"], ScenarioError, "unknown field"),
        (["crate.mass_kg=1"], ScenarioError, r"expected the path of a field, such as box.mass_kg, got crate.mass_kg"),
        (["box.shape=ball"], ScenarioError, r"box.shape.*expected one of cuboid, cylinder, l_shape, wedge, got 'ball'"),
        (["box.shape=cylinder"], ScenarioError, "equal length and width of a cylinder"),
        (["box.mass_kg=1", "box.mass_kg=2"], ConfigError, "each field once in --sweep, got box.mass_kg twice"),
        (["box.size_m=0.4x0.5"], ScenarioError, "box.size_m"),
    ],
)
def test_a_sweep_that_cannot_be_made_is_refused(sweeps: list[str], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        make_sweep(scenario_at_station(), sweeps, grid=False)
