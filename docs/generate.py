"""`python docs/generate.py`: writes the generated parts of the documentation.

These are the field tables of `protocol.md` and the JSON Schemas in `schemas/`, from the message types; the tables of
`architecture.md`, from docstrings and import contracts; those of `measured.md`, `scaling.md` and the README, from
results of studies and benchmarks and the templates in `templates/`; the list of studies in `experiments/README.md`;
the reasons of endings in `run.md`; all commands in `commands.md` and all public names in `api.md`; the tasks and their
terms in `learn.md`; the environments in `environment.md`; and the claims of the paper in `paper.md`. Everything
between the lines `<!-- generated: NAME -->` and `<!-- end -->` of a page is replaced; the rest is written by hand.
`llms.txt` lists all pages for programs that read them. A test fails when a generated part is stale.
"""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import msgspec
from msgspec import inspect

from docs import (
    claims,
    command_table,
    environment_tables,
    numbers,
    page_list,
    public_names,
    source_tree,
    study_list,
    term_tables,
)
from docs.field_texts import field_texts, flat, texts_below, tree_of
from docs.protocol_records import SECTIONS
from legpush import bounds
from legpush.messages.common import PROTOCOL_VERSION
from legpush.messages.schemas import MESSAGES, json_schema
from legpush.realism import bounds as limits
from legpush.runs.reasons import REASONS

DOCS: Final = Path(__file__).parent
PROTOCOL: Final = DOCS / "protocol.md"
ARCHITECTURE: Final = DOCS / "architecture.md"
MEASURED: Final = DOCS / "measured.md"
PAPER: Final = DOCS / "paper.md"
README: Final = DOCS.parent / "README.md"
RUN: Final = DOCS / "run.md"
COMMANDS: Final = DOCS / "commands.md"
API: Final = DOCS / "api.md"
LEARN: Final = DOCS / "learn.md"
ENVIRONMENT: Final = DOCS / "environment.md"
REALISM: Final = DOCS / "realism.md"
SCALING: Final = DOCS / "scaling.md"
EXPERIMENTS: Final = DOCS.parent / "experiments" / "README.md"
SCHEMAS: Final = DOCS / "schemas"
TEMPLATES: Final = tuple(sorted(path.stem for path in numbers.TEMPLATES.glob("*.md")))
"""Names of the generated parts with numbers."""
_BLOCK: Final = re.compile(r"(?<=<!-- generated: )(?P<name>\w+)(?P<open> -->\n).*?(?=<!-- end -->)", re.DOTALL)


def main() -> None:
    """Write all generated parts."""
    measured = measured_parts()
    for page, parts in (
        (PROTOCOL, protocol_parts()),
        (ARCHITECTURE, architecture_parts()),
        (MEASURED, measured),
        (PAPER, measured | claims.parts()),
        (README, measured),
        (REALISM, measured),
        (SCALING, measured),
        (EXPERIMENTS, experiments_parts()),
        (RUN, run_parts()),
        (COMMANDS, {"commands": command_table.command_tables()}),
        (API, {"names": public_names.public_names()}),
        (LEARN, term_tables.learn_parts()),
        (ENVIRONMENT, environment_tables.environment_parts()),
    ):
        page.write_text(filled(page.read_text(), parts))
    SCHEMAS.mkdir(exist_ok=True)
    for name, text in schemas().items():
        (SCHEMAS / name).write_text(text)
    page_list.LLMS.write_text(page_list.llms_text())


def filled(text: str, parts: Mapping[str, str]) -> str:
    """The page with its generated parts replaced."""
    return _BLOCK.sub(lambda found: f"{found['name']}{found['open']}\n{parts[found['name']]}\n", text)


def protocol_parts() -> dict[str, str]:
    """The generated parts of `protocol.md`: the version, the bounds, and the tables of records."""
    tables = {name: "\n".join(map(_table, records)) for name, records in SECTIONS.items()}
    return {"version": f"{PROTOCOL_VERSION}\n", "bounds": _bounds_table(), **tables}


def architecture_parts() -> dict[str, str]:
    """The generated parts of `architecture.md`: a table of each package, and the imports that are forbidden."""
    tables = {name: source_tree.package_table(name) for name in source_tree.FOLDERS}
    return {"rules": source_tree.shared_rules(), **tables}


def measured_parts() -> dict[str, str]:
    """The generated parts of `measured.md` and of the README: tables of measured numbers."""
    return {name: numbers.filled_template(name) for name in TEMPLATES}


def experiments_parts() -> dict[str, str]:
    """The generated parts of the README of the experiments: the lists of studies."""
    return {folder.partition("/")[0]: f"{study_list.study_list(folder)}\n" for folder in study_list.FOLDERS}


def run_parts() -> dict[str, str]:
    """The generated part of `run.md`: the reasons why missions end."""
    rows = [f"| `{name}` | {note.meaning} | {note.remedy or '-'} |" for name, note in REASONS.items()]
    return {"reasons": "\n".join(["| reason | meaning | what would change it |", "| --- | --- | --- |", *rows, ""])}


def schemas() -> dict[str, str]:
    """File names and contents: a JSON Schema (2020-12) per message; binary fields are base64 there."""
    return {f"{_snake(m.__name__)}.json": json.dumps(json_schema(m), indent=1) + "\n" for m in MESSAGES}


def _snake(name: str) -> str:
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()


def _table(record: type[msgspec.Struct]) -> str:
    """Heading, description and fields of a record."""
    lines = [f"#### {record.__name__}", "", flat(record.__doc__ or ""), ""]
    info = inspect.type_info(record)
    if not isinstance(info, inspect.StructType):
        raise TypeError(f"Expected a record, got {record}")
    meanings = dict(field_texts(record))
    rows = [
        (field.encode_name, _words(field.type), _default(field), meanings.get(field.name, "")) for field in info.fields
    ]
    if info.tag_field is not None:
        rows.insert(0, (info.tag_field, f'"{info.tag}"', "", "Says which kind of record this is."))
    if not rows:
        return "\n".join([*lines, "No fields.", ""])
    lines += ["| field | type | default | meaning |", "| --- | --- | --- | --- |"]
    lines += [f"| `{name}` | {words} | {default} | {meaning} |" for name, words, default, meaning in rows]
    return "\n".join([*lines, ""])


def _bounds_table() -> str:
    """The bounds of numbers with their reasons; bounds with one reason share a row."""
    lines = ["| bound | value | reason |", "| --- | --- | --- |"]
    sources = [(each, docs) for each in (bounds, limits) for docs in texts_below(tree_of(each).body)]
    for source, (names, reason) in sources:
        if not names[0].isupper():
            continue  # a type, not a number
        values = [getattr(source, name) for name in names]
        texts = (f"{value:g}" if isinstance(value, float) else str(value) for value in values)
        between = " to " if names[0].startswith("LEAST_") else ", "
        lines.append(f"| {', '.join(f'`{name}`' for name in names)} | {between.join(texts)} | {reason} |")
    return "\n".join([*lines, ""])


def _default(field: inspect.Field) -> str:
    """The value that an omitted field has."""
    if field.required:
        return "required"
    value = field.default if field.default is not msgspec.NODEFAULT else field.default_factory()
    plain = msgspec.to_builtins(value)
    return "all defaults" if isinstance(plain, dict) else f"`{json.dumps(plain)}`"


def _words(kind: inspect.Type) -> str:
    """A type in the words of MessagePack."""
    match kind:
        case inspect.FloatType():
            return f"number{_bounds(kind)}"
        case inspect.IntType():
            return f"integer{_bounds(kind)}"
        case inspect.BoolType():
            return "boolean"
        case inspect.StrType():
            if kind.max_length is not None:
                return f"string of at most {kind.max_length} characters"
            return f"string, `{kind.pattern}`".replace("|", "\\|") if kind.pattern else "string"
        case inspect.BytesType():
            bounded = kind.min_length is not None or kind.max_length is not None
            return f"binary, {kind.min_length or 0} to {kind.max_length} bytes" if bounded else "binary"
        case inspect.NoneType():
            return "nil"
        case inspect.LiteralType():
            return " or ".join(f'"{value}"' for value in kind.values)
        case inspect.StructType():
            return f"[{kind.cls.__name__}](#{kind.cls.__name__.lower()})"
        case inspect.UnionType():
            return " or ".join(_words(one) for one in kind.types)
        case inspect.TupleType():
            if len(set(map(_words, kind.item_types))) == 1:
                return f"array of {len(kind.item_types)} x {_words(kind.item_types[0])}"
            return f"array of {', '.join(map(_words, kind.item_types))}"
        case inspect.VarTupleType():
            low, high = kind.min_length, kind.max_length
            size = f" {low} to {high}" if low and high and low != high else f" {low}" if low == high and low else ""
            size = size or (f" at most {high}" if high else f" at least {low}" if low else "")
            return f"array of{size} x {_words(kind.item_type)}" if size else f"array of {_words(kind.item_type)}"
    raise TypeError(f"Expected a type of a message field, got {kind}")


def _bounds(kind: inspect.FloatType | inspect.IntType) -> str:
    gt, ge, lt, le = (f"{b:g}" if isinstance(b, float) else b for b in (kind.gt, kind.ge, kind.lt, kind.le))
    if ge is not None and le is not None:
        return f", {ge} to {le}"
    texts = [f"{sign} {bound}" for bound, sign in ((gt, ">"), (ge, ">="), (lt, "<"), (le, "<=")) if bound is not None]
    return f", {' and '.join(texts)}" if texts else ""


if __name__ == "__main__":
    main()
