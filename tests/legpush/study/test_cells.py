import numpy as np
import pytest
from msgspec import Struct

from legpush.errors import ConfigError, PluginError
from legpush.study.cells import CellError, CellKind, as_it_is, columns_of, kind_names, load_kind


class Empty(Struct):
    """Nothing."""


def returning(value: object) -> CellKind:
    return CellKind(specification=Empty, run=lambda _: value, resolved=Empty, resolve=as_it_is)  # type: ignore[arg-type,return-value]


def untyped(seed):  # type: ignore[no-untyped-def]
    return {"seed": seed}


def starred(*seeds: int) -> dict[str, int]:
    return {"n": len(seeds)}


def test_our_kinds_are_installed() -> None:
    assert set(kind_names()) >= {"mission", "push", "plan", "calibration", "training"}


def test_a_function_is_a_kind_with_its_parameters_as_fields() -> None:
    kind = load_kind("tests.legpush.study.stub:double")
    assert kind.specification.__struct_fields__ == ("seed", "factor")
    assert columns_of(kind, kind.specification(seed=4)) == {"value": 8.0}


@pytest.mark.parametrize("name", ["untyped", "starred"])
def test_a_function_whose_parameters_cannot_be_fields_is_refused(name: str) -> None:
    with pytest.raises(ConfigError, match=r"expected (a type for each parameter|parameters that can be given by name)"):
        load_kind(f"tests.legpush.study.test_cells:{name}")


def test_what_is_neither_a_kind_nor_a_function_is_refused() -> None:
    with pytest.raises(ConfigError, match="Expected a CellKind or a function at os:sep, got str"):
        load_kind("os:sep")


def test_an_unknown_kind_is_refused_with_the_valid_ones() -> None:
    with pytest.raises(PluginError, match=r"Expected a kind of cell .*push.*, got 'missions'"):
        load_kind("missions")


def test_numbers_of_numpy_become_plain_ones() -> None:
    got = columns_of(returning({"a": np.float64(1.5), "b": np.arange(2), "c": (True, None), "d": "x"}), Empty())
    assert got == {"a": 1.5, "b": [0, 1], "c": [True, None], "d": "x"}
    assert type(got["a"]) is float


@pytest.mark.parametrize(
    ("value", "error"), [(3, "a dictionary"), ({"a": {}}, "as a, got dict"), ({1: 2}, "a dictionary")]
)
def test_other_results_are_the_cells_error(value: object, error: str) -> None:
    with pytest.raises(CellError, match=error):
        columns_of(returning(value), Empty())
