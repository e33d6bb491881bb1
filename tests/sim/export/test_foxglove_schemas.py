"""Schemas of the messages that are plotted and listed."""

import jsonschema
import msgspec
import numpy as np
import pytest

from legpush.messages.stepping import Alter, Push, Walk
from sim_proc.export.columns import Column
from sim_proc.export.foxglove_schemas import STEP_SCHEMA, signals_schema


def test_a_signal_has_the_type_the_description_and_the_unit_of_its_column() -> None:
    schema = signals_schema(
        [
            Column(name="tick", unit="", about="control periods", values=np.arange(3)),
            Column(name="time_s", unit="s", about="simulated time", values=np.linspace(0.0, 1.0, 3)),
        ]
    )
    assert schema["properties"] == {
        "tick": {"type": "integer", "description": "control periods"},
        "time_s": {"type": "number", "description": "simulated time [s]"},
    }


@pytest.mark.parametrize("motion", [Push(w1=0.5, w2=0.4, leg="FL", depth_m=0.05), Walk(), Alter(box_mass_kg=0.5)])
def test_every_field_of_a_motion_is_described(motion: Push | Walk | Alter) -> None:
    fields = {name for name in msgspec.to_builtins(motion) if name != "kind"}
    assert fields <= STEP_SCHEMA["properties"].keys()


def test_a_step_with_a_word_for_a_number_does_not_pass() -> None:
    jsonschema.validate({"step": 1, "motion": "push", "w1": 0.5}, STEP_SCHEMA)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"step": 1, "motion": "push", "w1": "half"}, STEP_SCHEMA)
