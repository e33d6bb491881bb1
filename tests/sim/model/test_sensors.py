"""The sensors of the model."""

from legpush.realism.reality import Reality
from legpush.scene.scenario import Scenario
from sim_proc.model.world import build_model


def test_a_floor_with_tiles_has_the_same_sensors(at_the_box: Scenario) -> None:
    flat = build_model(at_the_box)
    tiled = build_model(at_the_box, Reality(tile_height_m=0.03, tile_size_m=1.0))
    assert [flat.sensor(i).name for i in range(flat.nsensor)] == [tiled.sensor(i).name for i in range(tiled.nsensor)]
    assert flat.nsensordata == tiled.nsensordata
