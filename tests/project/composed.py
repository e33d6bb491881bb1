"""The services of `compose.yaml`, and two ways to run their commands on a machine without a container engine."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

import yaml

from tests.ports import free_ports

VARIABLES: Final = {"SCENARIO": "push", "SEED": "3", "PROFILE": "/runs/small.toml", "STUDY": "small"}
"""What a user sets: the shortest mission, a short training, and a short study."""
OWNER: Final = "1000"
SECRETS: Final = "/run/secrets"
FROM_MACHINE: Final = ("/usr", "/bin", "/lib", "/lib64", "/etc", "/dev", "/proc")
"""What a contained process sees of this machine, besides Python."""

Service = dict[str, Any]


def read_compose(root: Path) -> dict[str, Any]:
    """Read the file, with variables replaced as compose does."""
    text = re.sub(
        r"\$\{(\w+):-([^}]*)\}",
        lambda match: VARIABLES.get(match[1], match[2]),
        (root / "compose.yaml").read_text(),
    )
    assert "${" not in text
    found: dict[str, Any] = yaml.safe_load(text.replace("$$", "$"))
    return found


def endpoints(words: Iterable[str]) -> list[tuple[str, str]]:
    """Return hosts and ports in a command."""
    return re.findall(r"tls/([\w.]+):(\d+)", " ".join(words))


class OnThisMachine:
    """Runs commands with free ports of 127.0.0.1 for the endpoints, and folders of the test for mounted ones."""

    def __init__(self, root: Path, folder: Path) -> None:
        self._compose, self._folder = read_compose(root), folder
        commands = [service["command"] for service in self._compose["services"].values()]
        ports = sorted({port for command in commands for _, port in endpoints(command)})
        self._ports = dict(zip(ports, free_ports(len(ports)), strict=True))
        self._page = free_ports(1)[0]

    def end(self) -> None:
        """There is nothing to end."""

    def words(self, name: str, command: list[str], copy: int = 0) -> list[str]:
        """Return what starts a command of a service here."""
        service = self._compose["services"][name]
        mounted = {volume["target"]: self._source(volume) for volume in service.get("volumes", ())}
        if "secrets" in service:
            mounted[SECRETS] = self._secrets(name, service["secrets"])
        given = [self._here(word, mounted, copy) for word in command]
        program = {"python": [sys.executable], "legpush": [str(Path(sys.executable).with_name("legpush"))]}
        return [*program.get(given[0], [given[0]]), *given[1:]]

    def environment(self, name: str) -> dict[str, str]:
        """Return the environment of a service."""
        del name
        return {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}

    def _here(self, word: str, mounted: dict[str, Path], copy: int) -> str:
        word = re.sub(r"tls/[\w.]+:(\d+)", lambda match: f"tls/127.0.0.1:{self._ports[match[1]]}", word)
        word = re.sub("^8765$", str(self._page), word)
        word = word.replace("$(hostname)", f"container{copy}")
        for target, source in mounted.items():
            word = re.sub(rf"(?<!\S){target}(?=[/\s]|$)", str(source), word)
        return word

    def _source(self, volume: Service) -> Path:
        return self._folder / str(volume["source"])

    def _secrets(self, name: str, secrets: list[str]) -> Path:
        """Return a folder that has the secrets of a service and nothing else."""
        folder = self._folder / f"secrets-of-{name}"
        folder.mkdir(exist_ok=True, mode=0o700)
        for secret in secrets:
            shutil.copy2(self._folder / self._compose["secrets"][secret]["file"], folder / secret)
        return folder


class Contained:
    """Runs commands as they stand, by Linux alone: a root of their own that is read-only, a network, a user, no rights.

    All services share one network, and the names of services are addresses of it.
    """

    def __init__(self, root: Path, folder: Path) -> None:
        self._compose, self._folder, self._root = read_compose(root), folder, root
        self._network = f"legpush-compose-{os.getpid()}"
        subprocess.run(["ip", "netns", "add", self._network], check=True)
        subprocess.run(["ip", "-n", self._network, "link", "set", "lo", "up"], check=True)
        self._hosts = folder / "hosts"
        self._hosts.write_text(f"127.0.0.1 localhost {' '.join(self._compose['services'])}\n")
        for mounted in ("runs", "secrets"):
            os.chown(folder / mounted, int(OWNER), int(OWNER))

    def end(self) -> None:
        """Remove the network."""
        subprocess.run(["ip", "netns", "del", self._network], check=True)

    def words(self, name: str, command: list[str], copy: int = 0) -> list[str]:
        """Return what starts a command of a service here."""
        service = self._compose["services"][name]
        assert service["read_only"] is True
        assert service["cap_drop"] == ["ALL"]
        top = self._folder / f"root-of-{name}-{copy}"
        top.mkdir(exist_ok=True)
        mounts = "\n".join(f"{line} || exit 99" for line in self._mounts(service, top))
        rights = "--no-new-privs --bounding-set=-all --inh-caps=-all"
        user = f"setpriv --reuid {OWNER} --regid {OWNER} --clear-groups {rights}"
        script = f"hostname container{copy}\n{mounts}\nexec chroot {top} {user} {shlex.join(command)}"
        return ["ip", "netns", "exec", self._network, "unshare", "--mount", "--uts", "sh", "-c", script]

    def environment(self, name: str) -> dict[str, str]:
        """Return the environment of a service: that of the image, and its own."""
        own: dict[str, str] = self._compose["services"][name]["environment"]
        path = f"{Path(sys.executable).parent}:/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin"
        return {"PATH": path, "PYTHONUNBUFFERED": "1", "PYTHONPATH": "/src:/src/shared", **own}

    def _mounts(self, service: Service, top: Path) -> Iterable[str]:
        """Yield commands that put together the root of a container at `top`."""
        yield "mount --make-rprivate /"
        yield f"mount -t tmpfs -o mode=755 tmpfs {top}"
        for writable in service["tmpfs"]:
            yield f"mkdir -p {top}{writable} && mount -t tmpfs -o mode=1777 tmpfs {top}{writable}"
        python = {sys.prefix, sys.base_prefix}
        shown = {**{path: path for path in (*FROM_MACHINE, *python)}, "/src": str(self._root)}
        for volume in service.get("volumes", ()):
            shown[volume["target"]] = str(self._folder / str(volume["source"]))
        for target, source in shown.items():
            yield f"mkdir -p {top}{target} && mount --rbind {source} {top}{target}"
        yield f"mount --bind {self._hosts} {top}/etc/hosts"
        for secret in service.get("secrets", ()):
            source = self._folder / self._compose["secrets"][secret]["file"]
            at = f"{top}{SECRETS}/{secret}"
            yield f"mkdir -p {top}{SECRETS} && touch {at} && mount --bind {source} {at}"
        yield f"mount -o remount,ro {top}"
