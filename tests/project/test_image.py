"""The container image: what goes in is enough to install legpush, and what runs in it is not root."""

import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest


@pytest.fixture(scope="module")
def instructions(root: Path) -> list[tuple[str, list[str]]]:
    """Each instruction of the Dockerfile with its words, continuation lines joined."""
    text = (root / "Dockerfile").read_text().replace("\\\n", " ")
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    return [(words[0], words[1:]) for words in map(shlex.split, lines)]


@pytest.fixture(scope="module")
def copied(instructions: list[tuple[str, list[str]]]) -> list[str]:
    """The paths of the checkout that go into the image."""
    return [source for name, words in instructions if name == "COPY" for source in words[:-1]]


def test_what_is_copied_into_the_image_builds_the_same_wheel_as_the_checkout(
    root: Path, tmp_path: Path, copied: list[str]
) -> None:
    image = tmp_path / "image"
    image.mkdir()
    for source in copied:
        if (root / source).is_dir():
            shutil.copytree(root / source, image / source)
        else:
            shutil.copy(root / source, image)
    wheels = []
    for place in (root, image):
        folder = tmp_path / f"from-{place.name}"
        build = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(place)]
        subprocess.run(build, check=True, capture_output=True)
        (wheel,) = folder.glob("*.whl")
        with ZipFile(wheel) as archive:
            wheels.append({name: archive.read(name) for name in archive.namelist()})
    assert wheels[0] == wheels[1]


def test_what_is_copied_into_the_image_is_not_ignored_and_nothing_else_is_sent(root: Path, copied: list[str]) -> None:
    lines = (root / ".dockerignore").read_text().split()
    assert lines[0] == "*"
    assert {line[1:] for line in lines if line.startswith("!")} == set(copied)


def test_the_image_runs_as_a_user_of_its_own(instructions: list[tuple[str, list[str]]]) -> None:
    users = [words for name, words in instructions if name == "USER"]
    assert users == [["legpush"]]


def test_the_image_and_the_check_of_a_bare_machine_install_the_same_libraries(
    root: Path, instructions: list[tuple[str, list[str]]]
) -> None:
    installed = {word for name, words in instructions if name == "RUN" for word in words if word.startswith("lib")}
    (line,) = [line for line in (root / ".ci" / "run").read_text().splitlines() if line.startswith("packages=")]
    assert installed == set(line.removeprefix("packages=(").removesuffix(")").split())
