"""An emulated Haswell computes the bits of this processor: planner, simulator, push cycle and policy.

An emulator cannot show what approximate instructions (`rsqrtps`, `rcpps`) give on real processors, and where this
processor has no AVX-512, the native side shows less: without the profile its numbers could be the same.
"""

import os
from typing import Final

import msgspec
import pytest

from legpush.canary import Canary
from legpush.numerics.profile import VARIABLE, with_profile
from tests.processors import emulated, python, qemu

CANARY: Final = "import sys, msgspec, legpush.canary as c; sys.stdout.buffer.write(msgspec.json.encode(c.compute()))"
WHY: Final = "from legpush.numerics.current import current as c; print(f'{c().profile}: {c().why_native}')"

pytestmark = pytest.mark.skipif(
    qemu() is None and not os.environ.get("CI"), reason="no qemu-x86_64: Debian's package qemu-user has it"
)


def test_an_emulated_processor_without_avx2_cannot_keep_the_profile() -> None:
    """It shows as well that the libraries look at the emulated processor."""
    without = {"OPENBLAS_CORETYPE": "", "NPY_DISABLE_CPU_FEATURES": "", "GLIBC_TUNABLES": ""}
    told = emulated("Nehalem", "-c", WHY, environment={**os.environ, VARIABLE: "x86-64-v3", **without})
    assert told == "native: NumPy finds no AVX2 and FMA on this processor, only X86_V2\n"


@pytest.mark.timeout(600)
def test_the_canary_of_an_emulated_haswell_is_the_one_of_this_processor() -> None:
    environment = with_profile(os.environ)
    native = python("-c", CANARY, environment=environment).stdout
    assert emulated("Haswell", "-c", CANARY, environment=environment) == native
    assert msgspec.json.decode(native, type=Canary).crc
