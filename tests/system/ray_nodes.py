"""Ray nodes in network namespaces of their own, as machines on a private network."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

PORT: Final = 6390
CLIENT_PORT: Final = 10001
RAY: Final = str(Path(sys.executable).with_name("ray"))
ENVIRONMENT: Final = {"RAY_USAGE_STATS_ENABLED": "0", "RAY_AUTH_MODE": "token", "PYTHONPATH": os.pathsep.join(sys.path)}
START_S: Final = 90.0


def can_have_namespaces() -> bool:
    """Return whether Ray is installed and this user may make network namespaces."""
    return os.getuid() == 0 and bool(shutil.which("ip") and shutil.which("unshare")) and find_spec("ray") is not None


@dataclass(frozen=True)
class Machine:
    """A network namespace with an address and a host name, in which programs run."""

    name: str
    address: str

    def inside(self, command: list[str]) -> list[str]:
        """Return the command that runs another one in here."""
        script = f'hostname {self.name} && exec "$@"'
        return ["ip", "netns", "exec", self.name, "unshare", "--uts", "sh", "-c", script, "sh", *command]

    def run(self, *command: str, environment: Mapping[str, str]) -> None:
        """Run a program to its end, which must be a good one."""
        with TemporaryDirectory() as folder, (Path(folder) / "output").open("w+") as output:
            # A pipe would stay open in the processes that the program leaves behind.
            done = subprocess.run(
                self.inside(list(command)), env=environment, stdout=output, stderr=output, timeout=START_S, check=False
            )
            output.seek(0)
            assert done.returncode == 0, output.read()

    def start_head(self, n_cpus: int, environment: Mapping[str, str]) -> None:
        """Start the head of a cluster."""
        self._start(n_cpus, environment, "--head", f"--port={PORT}", "--include-dashboard=false")

    def start_node(self, head: "Machine", n_cpus: int, environment: Mapping[str, str]) -> None:
        """Start a node of a cluster."""
        self._start(n_cpus, environment, f"--address={head.address}:{PORT}")

    def kill_all(self) -> None:
        """Kill every process in here, as when a machine loses its power."""
        found = subprocess.run(["ip", "netns", "pids", self.name], capture_output=True, text=True, check=False)
        for pid in found.stdout.split():
            subprocess.run(["kill", "-KILL", pid], check=False, stderr=subprocess.DEVNULL)

    def _start(self, n_cpus: int, environment: Mapping[str, str], *options: str) -> None:
        here = (f"--node-ip-address={self.address}", f"--num-cpus={n_cpus}", "--object-store-memory=80000000")
        temporary = f"--temp-dir=/tmp/{self.name}"
        self.run(RAY, "start", *here, temporary, "--disable-usage-stats", *options, environment=environment)


@contextmanager
def two_machines() -> Iterator[tuple[Machine, Machine]]:
    """Make two network namespaces with a cable between them, and remove them with all that runs in them."""
    # The names are in the paths of sockets, which must be short.
    one, two = Machine("legpush-1", "10.77.31.1"), Machine("legpush-2", "10.77.31.2")
    try:
        for machine in (one, two):
            _ip("netns", "add", machine.name)
        _ip("link", "add", "cable1", "netns", one.name, "type", "veth", "peer", "name", "cable2", "netns", two.name)
        for machine, cable in ((one, "cable1"), (two, "cable2")):
            _ip("-n", machine.name, "addr", "add", f"{machine.address}/24", "dev", cable)
            _ip("-n", machine.name, "link", "set", "lo", "up")
            _ip("-n", machine.name, "link", "set", cable, "up")
        yield one, two
    finally:
        for machine in (one, two):
            machine.kill_all()
            subprocess.run(["ip", "netns", "del", machine.name], check=False)
            shutil.rmtree(Path("/tmp") / machine.name, ignore_errors=True)


def _ip(*arguments: str) -> None:
    subprocess.run(["ip", *arguments], check=True)
