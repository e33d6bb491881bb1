"""Models become files of a recording, once each, and only while something records."""

import json
from types import SimpleNamespace
from typing import Any

import mujoco
import pytest
from msgspec.structs import replace

from legpush.messages.stepping import Push, Reset
from legpush.numerics.current import current
from legpush.scene.scenario import Scenario
from sim_proc.described_simulator import MAX_MODELS, DescribedSimulator


class Attachments:
    """A bus that keeps what is attached to recordings."""

    def __init__(self) -> None:
        self.files: dict[str, bytes] = {}
        self.buffer = SimpleNamespace(active=True)
        self.taps = SimpleNamespace(own=SimpleNamespace(buffer=self.buffer))

    def attach(self, name: str, media_type: str, data: bytes) -> None:
        kinds = {"xml": "application/xml", "json": "application/json"}
        assert media_type == kinds[name.rpartition(".")[2]]
        self.files[name] = data


@pytest.fixture
def bus() -> Any:
    return Attachments()


def test_each_scenario_is_described_once_by_a_model_that_compiles(bus: Any, at_the_box: Scenario) -> None:
    simulator = DescribedSimulator(bus)
    heavy = replace(at_the_box, box=replace(at_the_box.box, mass_kg=0.7))
    for scenario in (at_the_box, heavy, at_the_box):
        simulator.perform(Reset(scenario=scenario, seed=0), with_trace=False)

    assert list(bus.files) == ["numerics.json", "model.xml", "model-1.xml"]
    assert json.loads(bus.files.pop("numerics.json"))["name"] == current().name
    models = [mujoco.MjModel.from_xml_string(xml.decode()) for xml in bus.files.values()]
    assert [model.body("box").mass[0] for model in models] == pytest.approx([at_the_box.box.mass_kg, 0.7])


def test_without_a_recorder_nothing_is_described_and_outcomes_are_the_same(bus: Any, at_the_box: Scenario) -> None:
    motions = (Reset(scenario=at_the_box, seed=0), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05))
    recorded, bare = (
        [simulator.perform(motion, with_trace=False) for motion in motions]
        for simulator in (DescribedSimulator(bus), DescribedSimulator(bus))
    )
    assert recorded == bare

    bus.files.clear()
    bus.buffer.active = False
    DescribedSimulator(bus).perform(motions[0], with_trace=False)
    assert bus.files == {}


def test_a_training_that_draws_scenarios_does_not_attach_them_all(bus: Any, at_the_box: Scenario) -> None:
    simulator = DescribedSimulator(bus)
    for index in range(MAX_MODELS + 2):
        box = replace(at_the_box.box, mass_kg=0.1 + 0.01 * index)
        simulator.perform(Reset(scenario=replace(at_the_box, box=box), seed=0), with_trace=False)
    assert len(bus.files) == 1 + MAX_MODELS
