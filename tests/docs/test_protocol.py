"""The protocol's document and schemas say what the message types say, and golden messages fit them."""

import json
import re
from pathlib import Path

import jsonschema
import pytest

from docs import generate
from legpush.bus import keys
from legpush.bus.endpoints import LISTENING, own_directory
from legpush.messages.common import PROTOCOL_VERSION

GOLDEN = Path(__file__).parents[1] / "golden"
SCHEMA_OF = {"action": "action", "plan_request": "plan_request", "plan_result": "plan_result"}
TEXT = generate.PROTOCOL.read_text()


def test_the_generated_parts_of_the_document_are_up_to_date() -> None:
    parts = generate.protocol_parts()
    assert generate.filled(TEXT, parts) == TEXT, "run `python docs/generate.py`"
    blocks = re.findall(r"<!-- generated: (\w+) -->", TEXT)
    assert sorted(blocks) == sorted(parts)
    assert TEXT.count("<!-- end -->") == len(blocks)
    assert f"-->\n\n{PROTOCOL_VERSION}\n" in TEXT


def test_every_record_that_a_table_refers_to_has_a_table() -> None:
    targets = set(re.findall(r"\]\(#([a-z0-9]+)\)", TEXT))
    headings = {heading.lower() for heading in re.findall(r"^#### (\w+)$", TEXT, re.MULTILINE)}

    assert targets <= headings


def test_the_bounds_are_numbers_and_only_a_least_and_a_largest_one_are_an_interval() -> None:
    rows = re.findall(r"^\| (`[A-Z_`, ]+`) \| (.*?) \|", generate.protocol_parts()["bounds"], re.MULTILINE)
    assert rows
    for names, values in rows:
        assert all(float(value) >= 0 for value in re.split(" to |, ", values))
        assert (" to " in values) == ("LEAST_" in names and ", " in names), names
    assert "typing." not in TEXT


def test_the_schemas_are_up_to_date() -> None:
    files = {path.name: path.read_text() for path in generate.SCHEMAS.iterdir()}

    assert files == generate.schemas(), "run `python docs/generate.py`"


@pytest.mark.parametrize("path", sorted(GOLDEN.glob("*.json")), ids=lambda path: path.stem)
def test_a_golden_message_fits_its_schema_and_a_wrong_one_does_not(path: Path) -> None:
    name = next((schema for start, schema in SCHEMA_OF.items() if path.stem.startswith(start)), path.stem)
    schema = json.loads((generate.SCHEMAS / f"{name}.json").read_text())
    validator = jsonschema.Draft202012Validator(schema)
    message = json.loads(path.read_text())

    validator.validate(message)
    assert not validator.is_valid({**message, "header": {**message["header"], "sequence": -1}})
    assert not validator.is_valid({**message, "surplus": 1})


def test_the_keys_and_ports_of_the_document_are_those_of_the_code() -> None:
    made = [
        keys.plan_request("R", "<client>"),
        keys.plan_cancel("R", "<client>"),
        keys.plan_result("R", "<client>"),
        keys.action("R", "<name>"),
        keys.observation("R", "<name>"),
        keys.status("R", "<role>", "<name>"),
        keys.copies("R", "<role>", "<name>"),
        keys.reward("R", "<sim>"),
        keys.taken("R", "<role>", "<name>"),
        keys.liveliness("R", "<role>", "<name>", "<incarnation>"),
    ]
    for key in made:
        assert f"| `{key.replace(f'v{PROTOCOL_VERSION}', 'vV')}` |" in TEXT
    assert all(f"{role}.sock" in TEXT for role in LISTENING)
    assert f"{own_directory().name.partition('.')[0]}.<user id>" in TEXT
