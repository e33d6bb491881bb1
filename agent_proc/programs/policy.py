"""Trained policies as a program: `legpush policy show NAME`."""

import sys
from pathlib import Path
from typing import Final

from agent_proc.policies.card import CARD_FILE, readme
from agent_proc.policies.folder import (
    OLD_FORMAT,
    README_FILE,
    PolicyFolder,
    encode_card,
    is_old_format,
    read_policy,
    trained_path,
    write_policy,
)
from agent_proc.policies.learning_libraries import learning_libraries
from legpush.files import replace_folder
from legpush.options.policies import ExportPolicy, ShowPolicy
from legpush.output.reply import document
from legpush.service import run_command

ONNX_FILE: Final = "policy.onnx"


def main() -> int:
    """Parse the command line, whose first word is `show` or `export`, and do it; returns the exit code."""
    word, *arguments = sys.argv[1:]
    kind: type[ShowPolicy | ExportPolicy] = ShowPolicy if word == "show" else ExportPolicy
    return run_command(f"policy {word}", kind, run, arguments)


def run(options: ShowPolicy | ExportPolicy) -> int:
    """Show or export a policy; returns the exit code.

    Raises:
        PolicyError: There is no such policy, or it cannot be used.
        DiskError: It cannot be written.
    """
    policy = read_any_policy(options.policy)
    if isinstance(options, ShowPolicy):
        sys.stdout.write(readme(policy.card))
        document(policy.card)
        return 0
    if options.to == "safetensors":
        write_policy(options.out, policy)
    else:
        _write_onnx(options.out, policy)
    files = sorted(path.name for path in options.out.iterdir())
    sys.stdout.write(f"wrote {options.out}: {', '.join(files)}\n")
    document({"folder": options.out, "files": files})
    return 0


def read_any_policy(name: str) -> PolicyFolder:
    """Read a shipped policy, or a policy folder of the present or the earlier format.

    Raises:
        PolicyError: There is none, or one of its files cannot be used.
    """
    path = trained_path(name)
    if not is_old_format(path):
        return read_policy(path)
    with learning_libraries(f"the policy {name!r} of format {OLD_FORMAT}"):
        from agent_proc.policies.sb3.old_folder import read_old_policy
    return read_old_policy(path)


def _write_onnx(folder: Path, policy: PolicyFolder) -> None:
    """Write the model with its card into a new folder."""
    from agent_proc.policies.onnx_file import encode_onnx

    model = encode_onnx(policy)

    def fill(part: Path) -> None:
        (part / ONNX_FILE).write_bytes(model)
        (part / CARD_FILE).write_bytes(encode_card(policy.card))
        (part / README_FILE).write_text(readme(policy.card), encoding="utf-8")

    replace_folder(folder, fill)
