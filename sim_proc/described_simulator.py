"""A simulator that hands its model to whoever records."""

from typing import Final

from legpush.bus.bus import Bus
from legpush.messages.stepping import Motion, Outcome, Reset
from legpush.scene.scenario import Scenario
from sim_proc.model.world import model_xml
from sim_proc.simulator import Simulator

MAX_MODELS: Final = 16
"""Of scenarios that differ, as in a training that draws them; the later ones are in the recorded resets."""


class DescribedSimulator:
    """A `Simulator` whose models become files of a recording, while there is one."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._simulator = Simulator()
        self._described: list[Scenario] = []

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Carry out one motion."""
        outcome = self._simulator.perform(motion, with_trace=with_trace)
        if isinstance(motion, Reset) and self._bus.taps.own.buffer.active:
            self._describe(motion.scenario)
        return outcome

    def _describe(self, scenario: Scenario) -> None:
        """Once for each scenario."""
        if scenario in self._described or len(self._described) >= MAX_MODELS:
            return
        number = len(self._described)
        self._described.append(scenario)
        name = f"model-{number}.xml" if number else "model.xml"
        self._bus.attach(name, "application/xml", model_xml(scenario).encode())
