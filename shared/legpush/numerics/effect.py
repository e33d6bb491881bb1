"""What the numerical libraries of this process chose, asked of themselves."""

import ctypes
from typing import Final, NamedTuple

from threadpoolctl import threadpool_info

from legpush.numerics.profile import OPENBLAS_CORE, above_v3, has_v3, simd

_LEAF_1: Final = 0
_LEAF_7: Final = 1
_LIBM: Final = {"FMA": (_LEAF_1, 2, 12), "AVX2": (_LEAF_7, 1, 5), "AVX512F": (_LEAF_7, 1, 16)}
"""Leaf of CPUID as glibc numbers them, register (eax, ebx, ecx, edx), and bit of what libm chooses by."""


class Kernels(NamedTuple):
    """The code that runs, by library."""

    blas: tuple[str, ...]
    """Processors that each loaded OpenBLAS computes for; `unknown` for another BLAS."""
    simd: tuple[str, ...]
    """NumPy's names of the instructions that it uses."""
    libm: tuple[str, ...]
    """What glibc uses, among those that its functions are chosen by; `unknown` before glibc 2.33."""

    def why_not_v3(self) -> str:
        """Return what keeps these from being the profile x86-64-v3, for people; empty if they are."""
        if self.blas != (OPENBLAS_CORE,):
            return f"BLAS computes as on {' and '.join(self.blas) or 'an unknown processor'}, not as on {OPENBLAS_CORE}"
        if not has_v3(self.simd) or above_v3(self.simd):
            return f"NumPy uses {' '.join(self.simd)}"
        if self.libm != ("FMA", "AVX2"):
            return f"glibc uses {' '.join(self.libm) or 'neither FMA nor AVX2'}"
        return ""


class _Leaf(ctypes.Structure):
    """`struct cpuid_feature` of `<sys/platform/x86.h>`."""

    _fields_ = (("present", ctypes.c_uint * 4), ("active", ctypes.c_uint * 4))


def kernels() -> Kernels:
    """Return what NumPy, the loaded BLAS libraries and glibc use in this process; NumPy is imported."""
    baseline, found, _ = simd()
    loaded = [one for one in threadpool_info() if one["user_api"] == "blas"]
    blas = {one["architecture"] if one["internal_api"] == "openblas" else "unknown" for one in loaded}
    return Kernels(blas=tuple(sorted(blas)), simd=(*baseline, *found), libm=_libm())


def _libm() -> tuple[str, ...]:
    try:
        leaf = ctypes.CDLL(None).__x86_get_cpuid_feature_leaf
    except AttributeError:
        return ("unknown",)
    leaf.argtypes, leaf.restype = (ctypes.c_uint,), ctypes.POINTER(_Leaf)
    return tuple(
        name for name, (number, register, bit) in _LIBM.items() if leaf(number).contents.active[register] >> bit & 1
    )
