"""Numerics have a name that changes with everything that can change bits."""

import json

import pytest
from msgspec.structs import replace

from legpush.numerics.current import Numerics, current
from legpush.numerics.effect import Kernels
from legpush.numerics.profile import with_profile
from tests.processors import plain_environment, python

ONE = Numerics(
    profile="x86-64-v3",
    versions={"glibc": "2.36", "numpy": "2.4.6"},
    kernels=Kernels(blas=("Haswell",), simd=("X86_V2", "X86_V3"), libm=("FMA", "AVX2")),
)
NOTEBOOK = """
import logging, numpy, legpush
logging.basicConfig(format="%(name)s: %(message)s")
for _ in range(2):
    with legpush.world("push"): pass
print(legpush.__version__)
"""


def test_the_name_is_profile_and_identity() -> None:
    assert ONE.name == f"x86-64-v3/{ONE.identity}"
    assert len(ONE.identity) == 8
    assert json.loads(ONE.as_json())["name"] == ONE.name


@pytest.mark.parametrize(
    "other",
    [
        replace(ONE, profile="native"),
        replace(ONE, versions={**ONE.versions, "glibc": "2.41"}),
        replace(ONE, versions={**ONE.versions, "mujoco": "4.0.0"}),
        replace(ONE, kernels=ONE.kernels._replace(blas=("Zen",))),
    ],
)
def test_the_identity_depends_on_profile_versions_and_kernels(other: Numerics) -> None:
    assert other.identity != ONE.identity


def test_the_identity_does_not_depend_on_the_order_of_versions_nor_on_words() -> None:
    same = replace(ONE, versions=dict(reversed(ONE.versions.items())), why_native="for some reason")
    assert same.identity == ONE.identity


def test_versions_are_those_of_glibc_and_of_what_computes() -> None:
    assert list(current().versions) == ["glibc", "numpy", "scipy", "mujoco", "ompl"]


def test_a_process_that_loaded_numpy_before_says_once_that_it_is_native() -> None:
    done = python("-c", NOTEBOOK)
    told = [line for line in done.stderr.splitlines() if "numerics profile native" in line]
    native = python("-c", "from legpush.numerics.current import current; print(current().profile)").stdout
    assert len(told) == (native == "native\n")
    for line in told:
        assert "since this process was not started under the profile; `legpush python` does that" in line


def test_under_the_profile_nothing_is_told() -> None:
    assert python("-c", NOTEBOOK, environment=with_profile(plain_environment())).stderr == ""
