"""Reads the YAML of maps as `map_server` reads it. The only module with PyYAML."""

import re
from collections.abc import Collection
from typing import Any, Final

import yaml

NO_YAML: Final = (yaml.YAMLError, ValueError, RecursionError, LookupError, AttributeError, TypeError, OverflowError)
"""Errors that PyYAML raises for a damaged file, or for a value that is not what its tag says."""
QUOTES: Final = ("'", '"')
_TAG: Final = "tag:yaml.org,2002:"
_NUMBERS: Final = {
    "int": re.compile(r"\A[-+]?(0|[1-9][0-9]*)\Z"),
    "float": re.compile(
        r"\A[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\Z|\A[-+]?\.(inf|Inf|INF)\Z|\A\.(nan|NaN)\Z"
    ),
}
"""Numbers as C++ reads them. PyYAML alone reads `5e-17` as text, `010` as 8, `1_0` as 10, and `1:30` as 90."""


class RepeatedKeyError(Exception):
    """A key that stands twice in the file; its text says where."""


class _Loader(yaml.SafeLoader):
    """Reads numbers and tabs as yaml-cpp does, and refuses aliases and repeated keys.

    A map needs no alias, and a short file with aliases of aliases stands for countless values.
    """

    numeric: Collection[str] = ()
    """Keys of the file whose quoted values are read like plain ones."""

    def scan_to_next_token(self) -> None:
        """Skip to the next token; tabs between tokens of a line are skipped like spaces."""
        super().scan_to_next_token()
        while self.column > 0 and self.peek() == "\t":
            self.forward()
            super().scan_to_next_token()

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Compose the next value."""
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError("expected values, got an alias")
        return super().compose_node(parent, index)

    def compose_mapping_node(self, anchor: Any) -> Any:
        """Compose a table."""
        node = super().compose_mapping_node(anchor)
        lines: dict[str, int] = {}
        for key, value in node.value:
            line = key.start_mark.line + 1
            if key.value in self.numeric:
                self._unquote(value)
            if not isinstance(key, yaml.ScalarNode):
                continue
            if key.value in lines:
                raise RepeatedKeyError(
                    f"at `{key.value}`: expected the key once, got it in line {lines[key.value]} and in line {line}"
                )
            lines[key.value] = line
        return node

    def _unquote(self, node: Any) -> None:
        """Let quoted values count as if they had no quotes."""
        for part in node.value if isinstance(node, yaml.SequenceNode) else (node,):
            if isinstance(part, yaml.ScalarNode) and part.style in QUOTES:
                part.tag = self.resolve(yaml.ScalarNode, part.value, (True, False))  # type: ignore[no-untyped-call]


_Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag in (f"{_TAG}bool", f"{_TAG}null")]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
for _kind, _pattern in _NUMBERS.items():
    _Loader.add_implicit_resolver(f"{_TAG}{_kind}", _pattern, list("+-.0123456789"))


def plain_yaml(content: bytes, numeric: Collection[str]) -> Any:
    """Return the values of a file. A byte that is not UTF-8 becomes U+FFFD, since it may stand in a comment.

    Raises:
        RepeatedKeyError: A key stands twice.
        Exception: One of `NO_YAML`: it is not YAML, or not a kind that is read.
    """
    loader = _Loader(content.decode("utf-8", errors="replace"))
    loader.numeric = numeric
    return loader.get_single_data()
