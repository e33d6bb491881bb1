"""Lines of the keys in the text of a TOML or JSON file, since its readers do not tell them."""

import re
from collections.abc import Sequence
from operator import itemgetter
from typing import Final

_BETWEEN: Final = re.compile(r"(?:[\s,]|#[^\n]*)*")
"""What may stand between keys and values."""
_STRING: Final = re.compile(r'"""(?:\\.|[^\\])*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:\\.|[^"\\])*"|\'[^\']*\'', re.DOTALL)
_BARE: Final = re.compile(r"[^\s,\]}#=:][^,\]}#\n]*")
_KEY: Final = re.compile(r'\s*(?:"(?P<double>(?:\\.|[^"\\])*)"|\'(?P<single>[^\']*)\'|(?P<bare>[\w-]+))\s*')

MOST_FAULTS: Final = 20
"""Most faults of a file that are told at once."""
_PATH: Final = re.compile(r"at `(?P<path>[^`]*)`")
"""How the text of a fault begins."""
Lines = dict[str, int]
"""Line of each key and of each element of an array by its path, such as `room.obstacles[0].x_min_m`."""


def lines_of(text: str) -> Lines:
    """Return the lines of a text that its reader accepted."""
    scanner = _Scanner(text)
    if text.lstrip().startswith("{"):
        scanner.skip()
        scanner.value("")
    else:
        scanner.document()
    return scanner.lines


def line_of(path: str, lines: Lines) -> int | None:
    """Return the line of the path, or of the innermost table around it that is in the text; None if there is none."""
    while path:
        if path in lines:
            return lines[path]
        path = path[: max(path.rfind("."), path.rfind("["), 0)]
    return None


def located_faults(faults: Sequence[str], where: str, lines: Lines) -> list[str]:
    """Return the texts of faults, each after the name of its file and its line, in the order of the lines.

    A fault that begins with no path, or with one that has no line, comes first. Of very many, the first are returned.
    """
    texts = []
    for fault in faults:
        path = _PATH.match(fault)
        line = line_of(path["path"], lines) if path else None
        texts.append((line or 0, f"{where}: {fault}" if line is None else f"{where}:{line}: {fault}"))
    told = [text for _, text in sorted(texts, key=itemgetter(0))]
    n_more = len(told) - MOST_FAULTS
    return told if n_more <= 0 else [*told[:MOST_FAULTS], f"and {n_more} more"]


class _Scanner:
    """Walks through a text once."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0
        self._counted = (0, 1)
        self._tables: dict[str, int] = {}
        self.lines: Lines = {}

    def document(self) -> None:
        """Walk through the tables of a TOML document."""
        table = ""
        self.skip()
        while self._at < len(self._text):
            if self._text.startswith("[", self._at):
                table = self._header()
            else:
                self._pair(table)
            self.skip()

    def skip(self) -> None:
        """Go on behind spaces, commas, line breaks and comments."""
        found = _BETWEEN.match(self._text, self._at)
        self._at = found.end() if found else self._at

    def value(self, path: str) -> None:
        """Go on behind a value, and note what is in it."""
        match self._text[self._at]:
            case "[":
                self._array(path)
            case "{":
                self._at += 1
                self.skip()
                while not self._text.startswith("}", self._at):
                    self._pair(path)
                    self.skip()
                self._at += 1
            case _:
                found = _STRING.match(self._text, self._at) or _BARE.match(self._text, self._at)
                self._at = found.end() if found else self._at + 1

    def _array(self, path: str) -> None:
        self._at += 1
        self.skip()
        index = 0
        while not self._text.startswith("]", self._at):
            self._note(f"{path}[{index}]")
            self.value(f"{path}[{index}]")
            self.skip()
            index += 1
        self._at += 1

    def _header(self) -> str:
        """Note a table, or the next one of an array of tables, and return its path."""
        begin, is_array = self._at, self._text.startswith("[[", self._at)
        self._at += 2 if is_array else 1
        path = ""
        keys = self._keys()
        for depth, key in enumerate(keys, start=1):
            path = _joined(path, key)
            if depth < len(keys) and path in self._tables:
                path = f"{path}[{self._tables[path]}]"
            if depth < len(keys):
                self._note(path, begin)
        if is_array:
            self._tables[path] = self._tables.get(path, -1) + 1
            path = f"{path}[{self._tables[path]}]"
        self._at += 2 if is_array else 1
        self._note(path, begin)
        return path

    def _pair(self, table: str) -> None:
        """Note a key, and go on behind its value."""
        begin, path = self._at, table
        for key in self._keys():
            path = _joined(path, key)
            self._note(path, begin)
        self._at += 1
        self.skip()
        self.value(path)

    def _keys(self) -> list[str]:
        """Go on behind a key with its dots, and return its parts."""
        keys = []
        while found := _KEY.match(self._text, self._at):
            keys.append(next(part for part in found.groups() if part is not None))
            self._at = found.end()
            if not self._text.startswith(".", self._at):
                break
            self._at += 1
        return keys

    def _note(self, path: str, at: int | None = None) -> None:
        """Note the line of a path at its first place."""
        at = self._at if at is None else at
        before, line = self._counted
        self._counted = (at, line + self._text.count("\n", before, at))
        self.lines.setdefault(path, self._counted[1])


def _joined(table: str, key: str) -> str:
    return f"{table}.{key}" if table else key
