"""The numerics profile `x86-64-v3`: environment variables that give every x86-64 processor with AVX2 the same bits.

OpenBLAS, NumPy and glibc choose their code by the processor when they are loaded. The profile makes all three choose
what an Intel Haswell gets, so it has to be in the environment of a process from its start on.
"""

import os
import sys
from collections.abc import Mapping
from typing import Final, Literal

Profile = Literal["x86-64-v3", "native"]
"""`native`: whatever the libraries choose on this processor."""

X86_64_V3: Final = "x86-64-v3"
VARIABLE: Final = "LEGPUSH_NUMERICS"
"""Names the profile that the environment was made for; `native`, set by the user, keeps the profile away."""
OPENBLAS_CORE: Final = "Haswell"

_AT_MOST_V3: Final = frozenset(
    ("X86_V2", "X86_V3", "SSE", "SSE2", "SSE3", "SSSE3", "SSE41", "POPCNT", "SSE42", "AVX", "F16C", "FMA3", "AVX2")
)
"""NumPy's names, old and new, for what every processor of this level has."""
_NO_AVX512: Final = ",".join(f"-AVX512{part}" for part in ("F", "CD", "BW", "DQ", "VL"))


def with_profile(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the environment with the variables of the profile.

    It is returned as it is if it was made for a profile already, or if this machine cannot keep one. What the user
    switched off in addition stays off. NumPy is imported for its own list of what can be switched off.
    """
    if VARIABLE in environment or why_not_here():
        return dict(environment)
    kept = {name: value for name, value in environment.items() if name != "NPY_ENABLE_CPU_FEATURES"}
    return {**kept, **profile_variables(environment)}


def profile_variables(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables of the profile; those that hold lists are joined with what the user switched off."""
    baseline, chosen, others = simd()
    above = [name for name in (*chosen, *others) if name not in _AT_MOST_V3 and name not in baseline]
    off = environment.get("NPY_DISABLE_CPU_FEATURES", "").replace(",", " ").split()
    tunables = [each for each in environment.get("GLIBC_TUNABLES", "").split(":") if each]
    hwcaps = "glibc.cpu.hwcaps="
    lists = [each.removeprefix(hwcaps) for each in tunables if each.startswith(hwcaps)]
    rest = [each for each in tunables if not each.startswith(hwcaps)]
    return {
        VARIABLE: X86_64_V3,
        "OPENBLAS_CORETYPE": OPENBLAS_CORE,
        "NPY_DISABLE_CPU_FEATURES": " ".join(dict.fromkeys((*off, *above))),
        "GLIBC_TUNABLES": ":".join((*rest, hwcaps + ",".join((*lists, _NO_AVX512)))),
    }


def why_not_here() -> str:
    """Return why this machine cannot keep the profile, for people; empty if it can."""
    if sys.platform != "linux" or os.uname().machine != "x86_64":
        return f"the profile {X86_64_V3} is for Linux on x86-64, this is {sys.platform} on {os.uname().machine}"
    if not glibc_version():
        return f"the profile {X86_64_V3} needs glibc, which this Python does not use"
    baseline, chosen, _ = simd()
    if not has_v3((*baseline, *chosen)):
        return f"NumPy finds no AVX2 and FMA on this processor, only {' '.join((*baseline, *chosen))}"
    return ""


def has_v3(names: tuple[str, ...]) -> bool:
    """Return whether NumPy uses AVX2 and FMA, by its own names."""
    return "X86_V3" in names or {"AVX2", "FMA3"} <= set(names)


def above_v3(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of what goes beyond the profile."""
    return tuple(name for name in names if name not in _AT_MOST_V3)


def glibc_version() -> str:
    """Return the version of glibc, such as 2.36; empty on another C library."""
    try:
        library, _, version = (os.confstr("CS_GNU_LIBC_VERSION") or "").partition(" ")
    except ValueError:
        return ""
    return version if library == "glibc" else ""


def simd() -> tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]]:
    """Return NumPy's own names of what it was built for, of what it chose besides, and of what it leaves aside."""
    import numpy as np

    # The type of `show_config` does not say that a mode returns a dictionary.
    config: object = np.show_config(mode="dicts")
    extensions = config.get("SIMD Extensions", {}) if isinstance(config, dict) else {}
    baseline, found, left = (tuple(extensions.get(key, ())) for key in ("baseline", "found", "not found"))
    return baseline, found, left
