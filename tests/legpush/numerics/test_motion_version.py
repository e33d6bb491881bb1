"""The version of the motions is another one whenever the published canary is."""

from importlib.resources import files

import msgspec

from legpush.canary import PUBLISHED_FILE, Canary
from legpush.numerics.motion_version import MOTION_VERSION, MOTIONS
from legpush.versions import installed_versions

CANARIES = {
    2: {"x86-64-v3/cc335fe7": "838386be"},
    3: {"x86-64-v3/cc335fe7": "b5101a16"},
    4: {"x86-64-v3/cc335fe7": "f3dd0732"},
    5: {"x86-64-v3/cc335fe7": "ac42b169"},
}
"""CRC of the canary that each version has, by the name of the numerics. Where `canaries.json` changes because motions
do, raise `MOTION_VERSION` and add a line; other numerics add to the line of the present version."""


def test_the_published_canaries_are_those_of_this_version() -> None:
    published = msgspec.json.decode(files("legpush").joinpath(PUBLISHED_FILE).read_bytes(), type=dict[str, Canary])
    assert {name: canary.crc for name, canary in published.items()} == CANARIES[MOTION_VERSION], (
        "the bits of motions changed: raise MOTION_VERSION and add a line to CANARIES"
    )


def test_the_present_version_is_the_last_and_all_differ() -> None:
    assert max(CANARIES) == MOTION_VERSION
    every = [(name, crc) for canaries in CANARIES.values() for name, crc in canaries.items()]
    assert len(every) == len(set(every))


def test_reports_and_journals_note_it() -> None:
    assert installed_versions()[MOTIONS] == str(MOTION_VERSION)
