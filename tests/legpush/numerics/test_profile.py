"""The variables of the profile: from NumPy's own list, beside what the user set, and only where they can be kept."""

import json
import os
import sys

import pytest

from legpush.numerics import profile
from legpush.numerics.profile import VARIABLE, profile_variables, simd, why_not_here, with_profile
from tests.processors import python

USED = "import json, numpy; print(json.dumps(numpy.show_config(mode='dicts')['SIMD Extensions']))"
NO_AVX512 = "glibc.cpu.hwcaps=-AVX512F,-AVX512CD,-AVX512BW,-AVX512DQ,-AVX512VL"
OLD = (("SSE", "SSE2", "SSE3"), ("SSSE3", "AVX", "F16C", "FMA3", "AVX2", "AVX512F", "AVX512_SKX"), ("AVX512_ICL",))
"""What NumPy 2.2 says of itself."""


def test_numpy_knows_every_name_even_if_warnings_are_errors() -> None:
    environment = with_profile({"PATH": os.environ["PATH"]})
    done = python("-W", "error", "-c", USED, environment=environment)
    assert done.returncode == 0, done.stderr
    used = json.loads(done.stdout)
    assert "X86_V4" not in used["found"]
    assert {*used["baseline"], *used["found"], *used["not found"]} == {name for names in simd() for name in names}


def test_a_name_that_numpy_does_not_know_is_an_error_there() -> None:
    environment = {**with_profile({}), "NPY_DISABLE_CPU_FEATURES": "AVX1024"}
    assert "AVX1024" in python("-W", "error", "-c", USED, environment=environment).stderr


def test_all_beyond_avx2_is_switched_off_by_the_names_of_the_installed_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(profile, "simd", lambda: OLD)
    variables = profile_variables({})
    assert variables == {
        VARIABLE: "x86-64-v3",
        "OPENBLAS_CORETYPE": "Haswell",
        "NPY_DISABLE_CPU_FEATURES": "AVX512F AVX512_SKX AVX512_ICL",
        "GLIBC_TUNABLES": NO_AVX512,
    }


def test_what_the_user_switched_off_stays_off_and_nothing_is_switched_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(profile, "simd", lambda: OLD)
    users = {
        "HOME": "/home/you",
        "NPY_ENABLE_CPU_FEATURES": "AVX512F",
        "NPY_DISABLE_CPU_FEATURES": "AVX2, AVX512F",
        "GLIBC_TUNABLES": "glibc.malloc.check=1:glibc.cpu.hwcaps=-ERMS",
    }
    made = with_profile(users)
    assert made["HOME"] == "/home/you"
    assert "NPY_ENABLE_CPU_FEATURES" not in made
    assert made["NPY_DISABLE_CPU_FEATURES"] == "AVX2 AVX512F AVX512_SKX AVX512_ICL"
    assert made["GLIBC_TUNABLES"] == f"glibc.malloc.check=1:{NO_AVX512.replace('=', '=-ERMS,')}"


@pytest.mark.parametrize("name", ["native", "x86-64-v3"])
def test_an_environment_that_was_made_for_a_profile_stays_as_it_is(name: str) -> None:
    assert with_profile({VARIABLE: name}) == {VARIABLE: name}


def test_a_processor_without_avx2_keeps_its_environment_and_the_reason_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(profile, "simd", lambda: (("X86_V2",), (), ("X86_V3", "X86_V4")))
    assert with_profile({"A": "b"}) == {"A": "b"}
    assert why_not_here() == "NumPy finds no AVX2 and FMA on this processor, only X86_V2"


def test_another_system_cannot_keep_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "darwin")
    assert why_not_here().startswith("the profile x86-64-v3 is for Linux on x86-64, this is darwin on ")


def test_another_c_library_cannot_keep_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "confstr", lambda name: None)
    assert why_not_here() == "the profile x86-64-v3 needs glibc, which this Python does not use"
