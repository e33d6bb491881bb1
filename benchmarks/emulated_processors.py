"""`python -m benchmarks.emulated_processors`: equal bits here and on emulated processors, under the profile.

Canary, estimator and whole missions run in one process each, here and under `qemu-x86_64 -cpu MODEL`. What the
libraries choose without the profile is noted for each, which shows what the profile changes. `docs/numerics.md` says
what an emulator cannot show.
"""

import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import tyro

from benchmarks.report import write_report
from legpush.errors import ConfigError
from legpush.numerics.profile import VARIABLE, with_profile
from legpush.policy_names import DEFAULT_POLICY
from legpush.processes.environment import ONE_THREAD

QEMU = "qemu-x86_64"
COMPUTE = """
import json, sys, msgspec, legpush
from legpush import canary
from legpush.numerics.current import current
from benchmarks.robot.estimator_bits import estimator_crc
crcs = {"canary": canary.compute().crc, "estimator": estimator_crc()}
for mission in sys.argv[2:]:
    scenario, seed = mission.split(":")
    crcs[mission] = legpush.run(scenario, seed=int(seed), policy=sys.argv[1]).state_crc
print(json.dumps({"numerics": current().name, "crcs": crcs}))
"""
KERNELS = """
import json
from legpush.numerics.current import current
print(json.dumps(current().kernels._asdict()))
"""


@dataclass(frozen=True, kw_only=True)
class Config:
    """What to compute, and on which processors."""

    processors: tuple[str, ...] = ("Haswell", "EPYC")
    """Models of qemu; `qemu-x86_64 -cpu help` lists them."""
    missions: tuple[str, ...] = ("push:0", "default:0")
    """Scenario and seed of each mission. An emulator is about forty times slower."""
    policy: str = DEFAULT_POLICY
    """The policy of the missions."""


def main(config: Config) -> int:
    """Compute everywhere, print and write the CRCs, and return 1 if any of them differs."""
    if shutil.which(QEMU) is None:
        raise ConfigError(f"Expected {QEMU}, which Debian's package qemu-user has")
    kept = {name: value for name, value in os.environ.items() if name != VARIABLE}
    profile = {**with_profile(kept), **ONE_THREAD}
    native = {**os.environ, VARIABLE: "native", "NPY_DISABLE_CPU_FEATURES": "", "GLIBC_TUNABLES": ""}
    native["OPENBLAS_CORETYPE"] = ""
    rows: dict[str, Any] = {}
    for processor, command in {"here": [], **{each: [QEMU, "-cpu", each] for each in config.processors}}.items():
        began = perf_counter()
        computed = _python(command, COMPUTE, (config.policy, *config.missions), profile)
        wall_s = perf_counter() - began
        rows[processor] = {**computed, "wall_s": round(wall_s, 1), "unforced": _python(command, KERNELS, (), native)}
        print(f"{processor}: {computed['crcs']}, {computed['numerics']}, {wall_s:.0f} s", flush=True)
    n_differing = sum(row["crcs"] != rows["here"]["crcs"] for row in rows.values())
    print(f"{n_differing} of {len(config.processors)} emulated processors differ")
    write_report("emulated_processors", {"processors": rows, "n_differing": n_differing})
    return int(n_differing > 0)


def _python(command: list[str], code: str, arguments: tuple[str, ...], environment: dict[str, str]) -> dict[str, Any]:
    argv = [*command, sys.executable, "-P", "-c", code, *arguments]
    done = subprocess.run(argv, env=environment, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Config)))
