"""The YAML of maps: read as yaml-cpp reads it, which other readers of YAML do not agree with."""

from typing import Any

import pytest
import yaml

from legpush.scenarios.maps.map_yaml import NO_YAML, RepeatedKeyError, plain_yaml


@pytest.mark.parametrize(
    ("line", "value"),
    [
        (b"n: 0.05", 0.05),
        (b"n: 5e-2", 0.05),
        (b"n: .5", 0.5),
        (b"n: -2.", -2.0),
        (b"n: +1", 1),
        (b"n: 010", 10.0),
        (b'n: "0.050000"', 0.05),
        (b"n: '1'", 1),
        (b'n: "true"', True),
        (b"n: [1, \"2.5\", '3']", [1, 2.5, 3]),
        (b"n:\t0.05\t# in metres", 0.05),
        (b"n: [1,\t2,\t3\t]", [1, 2, 3]),
        (b"n: 0.05 # K\xfcche", 0.05),
        (b"n: 0.05 # \x93large\x94 room", 0.05),
        ("n: 0.05 # Küche".encode(), 0.05),
        (b"\xef\xbb\xbfn: 1", 1),
    ],
)
def test_a_number_is_read_however_it_is_written(line: bytes, value: Any) -> None:
    assert plain_yaml(line + b"\n# K\xfcche\nimage: a.pgm\n", ["n"]) == {"n": value, "image": "a.pgm"}


@pytest.mark.parametrize("text", ["1_0", "1:30", "0x10", "one", "2001-01-01", "yes.", "0.05 m"])
def test_what_is_no_number_to_map_server_stays_a_text(text: str) -> None:
    for quoted in (text, f'"{text}"'):
        assert plain_yaml(f"n: {quoted}".encode(), ["n"]) == {"n": text}


def test_only_numbers_lose_their_quotes() -> None:
    assert plain_yaml(b'n: "1"\nimage: "1"\nmore: {n: "1"}', ["n"]) == {"n": 1, "image": "1", "more": {"n": 1}}


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"n: 1\nn: 2", "at `n`: expected the key once, got it in line 1 and in line 2"),
        (b"n: 1\n'n': 1", "at `n`: expected the key once, got it in line 1 and in line 2"),
        (b"a:\n  more: {b: 1, b: 1}", "at `b`: expected the key once, got it in line 2 and in line 2"),
        (b"image: x\nn: 1\n? image\n: y", "at `image`: expected the key once, got it in line 1 and in line 3"),
    ],
)
def test_a_key_that_stands_twice_is_refused_by_name(content: bytes, words: str) -> None:
    with pytest.raises(RepeatedKeyError, match=words):
        plain_yaml(content, ["n"])


def test_merged_keys_count_no_more_than_for_map_server() -> None:
    assert "n" not in plain_yaml(b"<<: {n: 1}\nimage: x", ["n"])


@pytest.mark.parametrize("content", [b"\tn: 1", b"n: [1", b"n: *a", b"\x00", b"a: 1\n---\nb: 1"])
def test_what_is_no_yaml_raises_an_error_of_the_list(content: bytes) -> None:
    with pytest.raises(NO_YAML):
        plain_yaml(content, ["n"])


def test_the_reader_of_others_is_left_alone() -> None:
    assert yaml.safe_load("n: 010") == {"n": 8}
