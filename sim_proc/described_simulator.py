"""A simulator that attaches the models of its scenarios, and its numerics, to recordings."""

from typing import Final

from legpush.bus.bus import Bus
from legpush.messages.stepping import Motion, Outcome, Reset
from legpush.numerics.current import NUMERICS_FILE, current
from legpush.realism.reality import AS_ASSUMED, Reality, drawn_reality
from legpush.scene.scenario import Scenario
from sim_proc.model.world import model_xml
from sim_proc.simulator import Simulator

MAX_MODELS: Final = 16
"""At most this many different models are attached. A training draws more scenarios; they are in its recorded resets."""


class DescribedSimulator:
    """A `Simulator` that attaches each new model as an MJCF file while its bus is recorded."""

    def __init__(self, bus: Bus) -> None:
        """Attach models to the recording of this bus."""
        self._bus = bus
        self._simulator = Simulator()
        self._described: list[tuple[Scenario, Reality]] = []

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Carry out one motion, and attach the model of a new scenario.

        Raises:
            MotionError: The present state does not allow the motion.
        """
        outcome = self._simulator.perform(motion, with_trace=with_trace)
        if isinstance(motion, Reset) and self._bus.taps.own.buffer.active:
            self._describe(motion)
        return outcome

    def _describe(self, reset: Reset) -> None:
        """Attach the model of an episode, once for each that differs, and the numerics with the first."""
        scenario, reality = reset.scenario, drawn_reality(reset.scenario.realism, reset.seed)
        described = scenario, AS_ASSUMED if reality.as_assumed else reality
        if described in self._described or len(self._described) >= MAX_MODELS:
            return
        number = len(self._described)
        if number == 0:
            self._bus.attach(NUMERICS_FILE, "application/json", current().as_json())
        self._described.append(described)
        name = f"model-{number}.xml" if number else "model.xml"
        self._bus.attach(name, "application/xml", model_xml(*described).encode())
