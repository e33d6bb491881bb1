"""Tells whether the bounds of a type alone refuse every number that is not finite."""

from typing import Any

from msgspec import inspect

_PLAIN = (
    inspect.NoneType,
    inspect.BoolType,
    inspect.IntType,
    inspect.StrType,
    inspect.BytesType,
    inspect.LiteralType,
    inspect.EnumType,
)


def bounds_every_float(kind: Any) -> bool:
    """Return whether every float in a record of this type has a least and a largest value, which NaN does not meet."""
    seen: set[type] = set()
    left: list[inspect.Type] = [inspect.type_info(kind)]
    while left:
        item = left.pop()
        if isinstance(item, inspect.FloatType):
            if (item.ge is None and item.gt is None) or (item.le is None and item.lt is None):
                return False
        elif isinstance(item, inspect.StructType):
            if item.cls not in seen:
                seen.add(item.cls)
                left += [field.type for field in item.fields]
        elif isinstance(item, inspect.UnionType):
            left += item.types
        elif isinstance(item, inspect.TupleType):
            left += item.item_types
        elif isinstance(item, inspect.VarTupleType):
            left.append(item.item_type)
        elif isinstance(item, inspect.Metadata):
            left.append(item.type)
        elif not isinstance(item, _PLAIN):
            return False
    return True
