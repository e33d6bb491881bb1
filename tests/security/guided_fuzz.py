"""Coverage-guided fuzzing of the message decoder and of the scenario reader, by Atheris:

    python -m tests.security.guided_fuzz messages --runs 1000000
    python -m tests.security.guided_fuzz scenarios --runs 100000

Atheris keeps each input that reaches new code and mutates it further. It begins with small seeds: a message of each
type, and the built-in scenarios. A message must be refused by a `MessageError` or survive the way through bytes; a
scenario must be refused by a `ScenarioError` of one line or survive the way through a file. Anything else ends the run,
and the input is kept in the folder of `--keep`.
"""

import argparse
import random
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

import atheris
import msgpack

with atheris.instrument_imports(include=["legpush", "tomllib"]):
    from legpush.errors import MessageError, ScenarioError, one_line
    from legpush.messages import codec
    from legpush.messages.schemas import MESSAGES as KINDS
    from legpush.scenarios.file import dump_scenario, load_scenario, scenario_names, scenario_source

MAX_BYTES: Final = {"messages": 2048, "scenarios": 4096}
INPUT_S: Final = 10
"""Longest time of one input on a busy machine."""
MEMORY_MB: Final = 1024


def try_message(data: bytes) -> None:
    """Decode a message; its first byte says of which type it is to be."""
    if not data:
        return
    kind = KINDS[data[0] % len(KINDS)]
    try:
        message = codec.decode(data[1:], kind)
    except MessageError:
        return
    again = codec.decode(codec.encode(message), kind)
    if type(message) is not kind or again != message:
        raise AssertionError(f"decoded to {message!r}, and from its own bytes to {again!r}")


def mutate_message(data: bytes, max_size: int, seed: int) -> bytes:
    """Change bytes as Atheris does, or a field of the map in them."""
    from tests.security.fuzz import retyped

    draw = random.Random(seed)
    if draw.random() < 0.5:
        try:
            plain = msgpack.unpackb(data[1:], strict_map_key=True)
        except (ValueError, msgpack.exceptions.UnpackException):
            plain = None
        if isinstance(plain, dict) and plain:
            return (data[:1] + retyped(draw, plain))[:max_size]
    mutated: bytes = atheris.Mutate(data, max_size)
    return mutated


def try_scenario(data: bytes, file: Path) -> None:
    """Read a scenario from a file with these bytes."""
    file.write_bytes(data)
    try:
        scenario = load_scenario(file)
    except ScenarioError as error:
        if not str(error) or one_line(str(error)) != str(error).replace("\n", r"\n"):
            raise AssertionError(f"expected a sentence, got {str(error)!r}") from error
        return
    file.write_text(dump_scenario(scenario))
    if load_scenario(file) != scenario:
        raise AssertionError(f"not the same after a way through a file: {scenario!r}")


def write_seeds(target: str, folder: Path) -> list[str]:
    """Write the inputs to begin with into a folder, and return words that occur in inputs."""
    if target == "scenarios":
        for name in scenario_names():
            text = scenario_source(name).read_bytes()
            (folder / name).write_bytes(text)
        return sorted({word for path in folder.iterdir() for word in path.read_text().split() if word.isidentifier()})
    from tests.security.fuzz import EXAMPLES

    for place, kind in enumerate(KINDS):
        for number, payload in enumerate(EXAMPLES[kind]):
            (folder / f"{kind.__name__}-{number}").write_bytes(bytes([place]) + payload)
    return sorted({field for kind in KINDS for field in kind.__struct_fields__})


def main(argv: Sequence[str] | None = None) -> None:
    """Fuzz one of the two readers; ends this process."""
    parser = argparse.ArgumentParser(prog="python -m tests.security.guided_fuzz")
    parser.add_argument("target", choices=MAX_BYTES)
    parser.add_argument("--runs", type=int, default=10_000, help="number of inputs")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, default=None, help="folder that keeps the inputs which reached new code")
    options = parser.parse_args(argv)
    with tempfile.TemporaryDirectory(prefix="legpush-fuzz-") as scratch:
        seeds, words = Path(scratch) / "seeds", Path(scratch) / "words"
        kept = Path(scratch) / "kept" if options.keep is None else options.keep
        seeds.mkdir()
        kept.mkdir(parents=True, exist_ok=True)
        words.write_text("".join(f'"{word}"\n' for word in write_seeds(options.target, seeds)))
        file = Path(scratch) / "scenario.toml"
        attempts: dict[str, Callable[[bytes], None]] = {
            "messages": try_message,
            "scenarios": lambda data: try_scenario(data, file),
        }
        flags = [f"-runs={options.runs}", f"-seed={options.seed}", f"-max_len={MAX_BYTES[options.target]}"]
        flags += [f"-timeout={INPUT_S}", f"-rss_limit_mb={MEMORY_MB}", f"-dict={words}"]
        flags += [f"-artifact_prefix={kept}/", "-print_final_stats=1", str(kept), str(seeds)]
        mutators = {"messages": {"custom_mutator": mutate_message}, "scenarios": {}}
        atheris.Setup([sys.argv[0], *flags], attempts[options.target], **mutators[options.target])
        atheris.Fuzz()


if __name__ == "__main__":
    main()
