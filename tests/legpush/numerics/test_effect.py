"""What the libraries chose is asked of themselves, and compared with the profile."""

import json

import pytest

from legpush.numerics.effect import Kernels
from legpush.numerics.profile import with_profile
from tests.processors import plain_environment, python

V3 = Kernels(blas=("Haswell",), simd=("X86_V2", "X86_V3"), libm=("FMA", "AVX2"))
PRINT = """
import json
if {scipy}: import scipy.linalg
from legpush.numerics.effect import kernels
print(json.dumps(kernels()))
"""


@pytest.mark.parametrize("scipy", [False, True])
def test_under_the_profile_all_three_libraries_follow_it(scipy: bool) -> None:
    done = python("-c", PRINT.format(scipy=scipy), environment=with_profile(plain_environment()))
    kernels = Kernels(*map(tuple, json.loads(done.stdout)))
    assert kernels.why_not_v3() == ""
    assert kernels == V3


@pytest.mark.parametrize("variable", ["OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "GLIBC_TUNABLES"])
def test_a_variable_that_is_missing_is_noticed_if_this_processor_has_more(variable: str) -> None:
    environment = {name: value for name, value in with_profile(plain_environment()).items() if name != variable}
    whole = python("-c", PRINT.format(scipy=False))
    done = python("-c", PRINT.format(scipy=False), environment=environment)
    field = ("OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "GLIBC_TUNABLES").index(variable)
    kernels, native = (Kernels(*map(tuple, json.loads(one.stdout))) for one in (done, whole))
    assert kernels[field] == native[field]
    assert (kernels.why_not_v3() == "") == (native[field] == V3[field])


@pytest.mark.parametrize(
    ("kernels", "why"),
    [
        (V3._replace(blas=("SkylakeX",)), "BLAS computes as on SkylakeX, not as on Haswell"),
        (V3._replace(blas=("Haswell", "unknown")), "BLAS computes as on Haswell and unknown, not as on Haswell"),
        (V3._replace(blas=()), "BLAS computes as on an unknown processor, not as on Haswell"),
        (V3._replace(simd=("X86_V2",)), "NumPy uses X86_V2"),
        (V3._replace(simd=("X86_V2", "X86_V3", "AVX10")), "NumPy uses X86_V2 X86_V3 AVX10"),
        (V3._replace(libm=("FMA", "AVX2", "AVX512F")), "glibc uses FMA AVX2 AVX512F"),
        (V3._replace(libm=("unknown",)), "glibc uses unknown"),
        (V3._replace(libm=()), "glibc uses neither FMA nor AVX2"),
        (V3._replace(simd=("SSE", "SSE2", "SSE3", "AVX", "F16C", "FMA3", "AVX2")), ""),
    ],
)
def test_the_first_library_that_does_not_follow_is_named(kernels: Kernels, why: str) -> None:
    assert kernels.why_not_v3() == why
