"""Slurm on one node, this machine, from the programs of Debian's packages `slurm-wlm` and `munge`."""

import getpass
import os
import platform
import secrets
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import Final

from tests.ports import free_ports

PROGRAMS: Final = ("munged", "slurmctld", "slurmd", "sbatch")
START_S: Final = 30.0
CONFIGURATION: Final = """
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={folder}/munge.sock
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=bf_interval=1,batch_sched_delay=0,sched_interval=1
SlurmdParameters=config_overrides
KillWait=2
JobRequeue=1
NodeName={host} NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def has_slurm() -> bool:
    """Return whether the programs are installed, and this user may start them."""
    return os.getuid() == 0 and all(shutil.which(name) for name in PROGRAMS)


@contextmanager
def slurm_node(folder: Path) -> Iterator[dict[str, str]]:
    """Run Slurm; yields the environment in which its commands find it."""
    host = platform.node().partition(".")[0]
    for part in ("state", "spool"):
        (folder / part).mkdir()
    key = folder / "munge.key"
    key.write_bytes(secrets.token_bytes(1024))
    key.chmod(0o400)
    file = folder / "slurm.conf"
    file.write_text(CONFIGURATION.format(host=host, user=getpass.getuser(), folder=folder, ports=free_ports(2)))
    environment = {**os.environ, "SLURM_CONF": str(file)}
    munge = ["munged", "--foreground", "--force", f"--key-file={key}", f"--socket={folder}/munge.sock"]
    munge += [f"--pid-file={folder}/munged.pid", f"--log-file={folder}/munged.log", f"--seed-file={folder}/seed"]
    with ExitStack() as stack:
        for command in (
            munge,
            ["slurmctld", "-D", "-c", "-f", str(file)],
            ["slurmd", "-D", "-N", host, "-f", str(file)],
        ):
            log = stack.enter_context((folder / f"{command[0]}.out").open("w"))
            process = subprocess.Popen(command, env=environment, stdout=log, stderr=subprocess.STDOUT)
            stack.callback(process.wait)
            stack.callback(process.terminate)
            sleep(0.5)
        _wait_until_idle(environment, folder)
        yield environment
        subprocess.run(["scancel", "--me"], env=environment, check=False)


def _wait_until_idle(environment: dict[str, str], folder: Path) -> None:
    deadline_s = monotonic() + START_S
    while monotonic() < deadline_s:
        done = subprocess.run(
            ["sinfo", "--noheader", "--format=%T"], env=environment, capture_output=True, text=True, check=False
        )
        if done.stdout.strip() == "idle":
            return
        sleep(0.2)
    logs = "\n".join(path.read_text() for path in folder.glob("*.out"))
    raise AssertionError(f"no Slurm after {START_S} s:\n{logs}")
