"""Recordings and policies with code in them that leaves marks when it runs."""

import base64
import hashlib
import io
import json
import pickle
import zipfile
from itertools import groupby
from pathlib import Path
from typing import Any

import msgspec

from legpush.recording.facts import MISSION_FILE, read_facts
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.mcap_file.writer import RecordingFile

IMPORTED, RAN = "imported", "ran"
"""Files in the working directory that appear when the code runs."""
MODULE = f"""
from pathlib import Path

Path("{IMPORTED}").touch()

from agent_proc.policies.scripted import ScriptedPolicy

def go():
    Path("{RAN}").touch()
    return ScriptedPolicy()
"""
"""It decides as the policy of the recording, so that nobody would notice."""


class Bomb:
    """Leaves a mark when it is unpickled."""

    def __reduce__(self) -> tuple[Any, ...]:
        return Path.touch, (Path(RAN),)


def marks(folder: Path) -> set[str]:
    """What has run in this working directory."""
    return {name for name in (IMPORTED, RAN) if (folder / name).exists()}


def forged(recording: Path, target: Path, policy: str, sha256: str) -> Path:
    """The same recording, whole and undamaged, with another policy in its facts."""
    old = read_recording([recording])
    facts = msgspec.json.encode(msgspec.structs.replace(read_facts(old), policy=policy, policy_sha256=sha256))
    file = RecordingFile(target, old.about)
    for attachment in old.attachments.values():
        is_mission = attachment.name.rpartition("/")[2] == MISSION_FILE
        file.attach(attachment._replace(data=facts) if is_mission else attachment)
    for origin, messages in groupby(old.messages, key=lambda message: message.origin):
        file.write(origin, tuple(message.copy for message in messages), old.marks)
    file.finish(old.completeness)
    return target


def write_module(folder: Path, name: str) -> str:
    """A module with a policy; its SHA-256."""
    (folder / f"{name}.py").write_text(MODULE)
    return hashlib.sha256(MODULE.encode()).hexdigest()


def write_plug_in(folder: Path, name: str) -> str:
    """An installed package with a policy as a plug-in; the SHA-256 of its module."""
    info = folder / "foreign-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: foreign\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[legpush.policies]\n{name} = foreign_policies:go\n")
    return write_module(folder, "foreign_policies")


def write_model(file: Path, n_seen: int = 8) -> str:
    """A model file with a bomb among its settings, whose plain text is that of a model that fits; its SHA-256."""
    box = {":type:": "<class 'gymnasium.spaces.box.Box'>"}
    data = {
        "policy_class": {"__module__": "stable_baselines3.common.policies"},
        "observation_space": {**box, "_shape": [n_seen]},
        "action_space": {**box, "_shape": [4]},
        "bomb": {":type:": "dict", ":serialized:": base64.b64encode(pickle.dumps(Bomb())).decode()},
    }
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("data", json.dumps(data))
    return hashlib.sha256(file.read_bytes()).hexdigest()


def weights_of_bombs() -> bytes:
    """The zip of a policy folder whose weights are a pickle with a bomb, as PyTorch would unpickle it."""
    inner = io.BytesIO()
    with zipfile.ZipFile(inner, "w") as archive:
        archive.writestr("archive/data.pkl", pickle.dumps({"weights": Bomb()}, protocol=2))
        archive.writestr("archive/byteorder", "little")
        archive.writestr("archive/version", "3\n")
    outer = io.BytesIO()
    with zipfile.ZipFile(outer, "w") as archive:
        archive.writestr("policy.pth", inner.getvalue())
    return outer.getvalue()
