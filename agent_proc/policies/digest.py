"""The SHA-256 of a policy, by which a recording knows it again."""

import hashlib
from pathlib import Path

import msgspec

from agent_proc.policies.card import CARD_FILE
from agent_proc.policies.folder import WEIGHTS_FILE, policy_path
from agent_proc.policies.folder_files import read_file
from agent_proc.task.terms import GROUP as TERMS
from agent_proc.task.terms import foreign_terms
from legpush.errors import PolicyError
from legpush.plugins import plugin_values
from legpush.policy_names import CODED, GROUP, policy_kind, source_sha256


def policy_sha256(name: str) -> str:
    """SHA-256 of the files of a policy by name, or of the source of one that is code; empty if it has neither.

    Nothing is imported to find it.

    Raises:
        PolicyError: There is no such policy, or one of its files cannot be read.
    """
    kind = policy_kind(name)
    if kind == "module:function":
        return source_sha256(name)
    if kind == "plug-in":
        return "".join(map(source_sha256, plugin_values(GROUP, name)))
    if name in CODED:
        return ""
    if kind == "model file":
        return hashlib.sha256(_model(Path(name))).hexdigest()
    folder = policy_path(name)
    digest = hashlib.sha256()
    for file in (CARD_FILE, WEIGHTS_FILE):
        if (folder / file).exists():
            digest.update(read_file(folder / file))
    for term in foreign_terms_of(folder):
        digest.update("".join(map(source_sha256, plugin_values(TERMS, term))).encode())
    return digest.hexdigest()


def foreign_terms_of(folder: Path) -> tuple[str, ...]:
    """Names of the terms of other packages in the task of a policy; nothing is imported to find them.

    A card that cannot be used has none.

    Raises:
        PolicyError: Its card cannot be read.
    """
    path = folder / CARD_FILE
    try:
        card = msgspec.json.decode(read_file(path)) if path.exists() else None
    except (msgspec.MsgspecError, RecursionError):
        return ()
    task = card.get("task") if isinstance(card, dict) else None
    return foreign_terms(task) if isinstance(task, dict) else ()


def _model(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise PolicyError(f"{path}: expected a model saved by Stable-Baselines3 ({error})") from error
