"""Arrays as data: they come back bit for bit, and never with another size than expected."""

from typing import get_args

import msgspec
import numpy as np
import pytest

from agent_proc.learning.plain_array import DType, PlainArray, from_plain, to_plain

FLOATS = np.array([[0.1, -0.0, np.nan], [np.inf, 1e-320, 2.0]])


def test_an_array_comes_back_bit_for_bit() -> None:
    plain = msgspec.msgpack.decode(msgspec.msgpack.encode(to_plain(FLOATS)), type=PlainArray)

    assert from_plain(plain, np.zeros((2, 3)), "x").tobytes() == FLOATS.tobytes()


@pytest.mark.parametrize("dtype", get_args(DType))
def test_every_type_comes_back_and_can_be_changed(dtype: str) -> None:
    array = np.arange(6).reshape(2, 3).T.astype(dtype)

    back = from_plain(to_plain(array), np.zeros_like(array), "x")
    np.testing.assert_array_equal(back, array)
    assert back.dtype == array.dtype
    back[0, 0] = 1


def test_a_single_number_is_an_array_without_axes() -> None:
    assert from_plain(to_plain(np.array(3.5)), np.zeros(()), "x")[()] == 3.5


@pytest.mark.parametrize("like", [np.zeros((3, 2)), np.zeros(6), np.zeros((2, 3), dtype=np.float32), np.zeros(())])
def test_another_shape_or_type_is_refused(like: np.ndarray) -> None:
    with pytest.raises(ValueError, match=r"at `here`: expected .* got 48 of float64 with shape \(2, 3\)"):
        from_plain(to_plain(FLOATS), like, "here")


def test_a_shape_that_claims_more_than_its_bytes_is_refused_before_it_is_made() -> None:
    liar = PlainArray(dtype="float64", shape=(2**40,), data=b"")

    with pytest.raises(ValueError, match="at `here`"):
        from_plain(liar, np.zeros(3), "here")


def test_objects_are_no_data() -> None:
    with pytest.raises(ValueError, match=r"Expected an array of bool, .* got object"):
        to_plain(np.array([object()]))
