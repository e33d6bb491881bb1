"""The canary shows whether a process computes what others do, and in which part it does not."""

import json
from importlib.resources import files

import msgspec
import pytest
from msgspec.structs import replace

from legpush import canary
from legpush.canary import PUBLISHED_FILE, Canary, published
from legpush.numerics.current import current

ONE = Canary(plan="00000001", walk="00000002", turn="00000005", push="00000003", learned="00000004")


@pytest.fixture(scope="module")
def computed() -> Canary:
    return canary.compute()


def test_it_is_the_published_one(computed: Canary) -> None:
    """Where a change moves a bit on purpose, `legpush canary` has the numbers for `canaries.json`."""
    expected = published(current().name)
    if expected is None:
        pytest.skip(f"no canary was published for {current().name}")
    assert computed == expected


def test_it_is_the_same_again(computed: Canary) -> None:
    assert canary.compute() == computed


def test_every_part_changes_its_crc() -> None:
    crcs = {replace(ONE, **{part: "ffffffff"}).crc for part in ONE.__struct_fields__}
    assert len({*crcs, ONE.crc}) == 6


def test_each_policy_chooses_its_own_push(computed: Canary) -> None:
    """So the CRCs of the pushes are those of decisions, too."""
    assert computed.push != computed.learned


def test_only_the_profile_is_published() -> None:
    text = files("legpush").joinpath(PUBLISHED_FILE).read_text()
    assert all(name.startswith("x86-64-v3/") for name in msgspec.json.decode(text, type=dict[str, Canary]))
    assert published("native/00000000") is None


@pytest.mark.parametrize(
    ("expected", "code", "words"),
    [
        (None, 0, "none for these numerics"),
        (ONE, 0, ONE.crc),
        (replace(ONE, walk="ffffffff"), 1, "this machine computes other bits than were published, in: walk"),
    ],
)
def test_the_command_tells_the_parts_that_differ(
    expected: Canary | None,
    code: int,
    words: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("sys.argv", ["canary"])
    monkeypatch.setattr(canary, "compute", lambda: ONE)
    monkeypatch.setattr(canary, "published", lambda name: expected if name == current().name else None)
    assert canary.main() == code
    told = capsys.readouterr().out
    assert words in told
    assert f"numerics    {current().name}" in told
    assert json.dumps(ONE.walk).strip('"') in told
