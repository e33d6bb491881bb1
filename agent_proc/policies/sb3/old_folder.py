"""Reads policy folders of format 1, whose networks are a zip of Stable-Baselines3, so that they can be converted."""

import io
import pickle
import zipfile
from pathlib import Path
from typing import Any, Final

import numpy as np
from msgspec import Struct
from stable_baselines3.common.save_util import load_from_zip_file

from agent_proc.policies.actor import Normalizer
from agent_proc.policies.card import CARD_FILE
from agent_proc.policies.folder import OLD_FORMAT, PolicyFolder, parse_card, widths
from agent_proc.policies.folder_files import decode_file, read_file, require_small_zip
from agent_proc.policies.sb3.layers import actor_layers
from agent_proc.policies.weights_file import decode_weights, encode_weights
from legpush.errors import PolicyError

NETWORKS_FILE: Final = "policy.zip"
NORMALIZER_FILE: Final = "normalizer.json"


class OldNormalizer(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The normalizer as it was written."""

    mean: tuple[float, ...]
    variance: tuple[float, ...]
    clip: float
    epsilon: float


def read_old_policy(folder: Path) -> PolicyFolder:
    """Read a folder of format 1; its weights are read as plain arrays, so it runs no code.

    Raises:
        PolicyError: A file is missing or cannot be used; the message names it.
    """
    card = parse_card(decode_file(folder / CARD_FILE, dict), folder / CARD_FILE, OLD_FORMAT)
    path = folder / NETWORKS_FILE
    layers = actor_layers(card.profile.algorithm, _weights(path))
    normalizer = None
    if card.profile.normalize_observation:
        old = decode_file(folder / NORMALIZER_FILE, OldNormalizer)
        normalizer = Normalizer(
            mean=np.array(old.mean), variance=np.array(old.variance), clip=old.clip, epsilon=old.epsilon
        )
    normalized = normalizer is not None
    # The same check as of a new file: that all arrays fit the card.
    checked, _ = decode_weights(
        encode_weights(layers, normalizer), widths(card), normalized=normalized, where=str(path)
    )
    return PolicyFolder(card=card, layers=checked, normalizer=normalizer)


def _weights(path: Path) -> dict[str, Any]:
    content = read_file(path)
    require_small_zip(content, str(path))
    try:
        _, weights, _ = load_from_zip_file(io.BytesIO(content), device="cpu", load_data=False)
    except (zipfile.BadZipFile, pickle.UnpicklingError, RuntimeError, ValueError, EOFError) as error:
        first_line = (str(error).splitlines() or [type(error).__name__])[0]
        raise PolicyError(f"{path}: expected a policy of Stable-Baselines3 ({first_line})") from error
    if weights is None or "policy" not in weights:
        raise PolicyError(f"{path}: expected weights named `policy`, got {', '.join(weights or ()) or 'none'}")
    return dict(weights["policy"])
