"""Arrays as plain data: type, shape and bytes, so that a file of them holds no code."""

from typing import Annotated, Any, Literal, get_args

import numpy as np
from msgspec import Meta, Struct
from numpy.typing import NDArray

DType = Literal["bool", "uint8", "int32", "int64", "uint32", "float32", "float64"]


class PlainArray(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An array as data; its elements are little-endian and in C order."""

    dtype: DType
    shape: tuple[Annotated[int, Meta(ge=0)], ...]
    data: bytes


def to_plain(array: NDArray[Any]) -> PlainArray:
    """A copy of the array as data.

    Raises:
        ValueError: Its type is none of those that a file may hold.
    """
    dtype = array.dtype.name
    if dtype not in get_args(DType):
        raise ValueError(f"Expected an array of {', '.join(get_args(DType))}, got {dtype}")
    return PlainArray(
        dtype=dtype,  # type: ignore[arg-type]
        shape=array.shape,
        data=array.astype(array.dtype.newbyteorder("<"), order="C").tobytes(),
    )


def from_plain(plain: PlainArray, like: NDArray[Any], name: str) -> NDArray[Any]:
    """A new array with the type and shape of `like`.

    Raises:
        ValueError: Type, shape or number of bytes differ; the message names the array.
    """
    dtype = np.dtype(plain.dtype)
    if (dtype, plain.shape, len(plain.data)) != (like.dtype, like.shape, like.nbytes):
        raise ValueError(
            f"at `{name}`: expected {like.nbytes} bytes of {like.dtype.name} with shape {like.shape}, got "
            f"{len(plain.data)} of {plain.dtype} with shape {plain.shape}"
        )
    return np.frombuffer(plain.data, dtype.newbyteorder("<")).reshape(plain.shape).astype(dtype)
