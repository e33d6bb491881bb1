"""The numerics of this process: its profile, verified, and the versions that decide about bits."""

import hashlib
import logging
import os
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Final

import msgspec
from msgspec import Struct

from legpush.numerics.effect import Kernels, kernels
from legpush.numerics.motion_version import MOTION_VERSION, MOTIONS
from legpush.numerics.profile import VARIABLE, X86_64_V3, Profile, glibc_version, why_not_here

log = logging.getLogger(__name__)

PACKAGES: Final = ("numpy", "scipy", "mujoco", "ompl")
"""Their versions decide about bits, besides that of glibc."""
NUMERICS_FILE: Final = "numerics.json"
"""Attachment of recordings in which a simulator notes its numerics."""


class Numerics(Struct, frozen=True, kw_only=True):
    """What a result was computed with, as far as it can change bits."""

    profile: Profile
    why_native: str = ""
    """Why the profile is not x86-64-v3, for people; empty if it is, or if the user asked for `native`."""
    versions: dict[str, str]
    """Of glibc and of the installed packages among `PACKAGES`."""
    kernels: Kernels

    @property
    def identity(self) -> str:
        """Eight hexadecimal digits; equal for equal profile, versions and kernels."""
        parts = (self.profile, sorted(self.versions.items()), self.kernels)
        return hashlib.sha256(msgspec.json.encode(parts)).hexdigest()[:8]

    @property
    def name(self) -> str:
        """Profile and identity, such as `x86-64-v3/1a2b3c4d`, as reports, journals and recordings have it."""
        return f"{self.profile}/{self.identity}"

    def as_json(self) -> bytes:
        """Return all fields, the name, and the version of the motions as JSON."""
        named = {"name": self.name, MOTIONS: str(MOTION_VERSION)}
        return msgspec.json.encode({**named, **msgspec.to_builtins(self)})


@cache
def current() -> Numerics:
    """Return the numerics of this process; NumPy is imported to verify what it uses.

    It is determined once, since the libraries choose when they are loaded.
    """
    found = kernels()
    versions = {"glibc": glibc_version() or "none"}
    for package in PACKAGES:
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            continue
    if os.environ.get(VARIABLE) == "native":
        return Numerics(profile="native", versions=versions, kernels=found)
    why = why_not_here() or found.why_not_v3()
    if why and VARIABLE not in os.environ and not why_not_here():
        why = f"{why}, since this process was not started under the profile; `legpush python` does that"
    profile: Profile = "native" if why else X86_64_V3
    return Numerics(profile=profile, why_native=why, versions=versions, kernels=found)


@cache
def tell_if_native() -> None:
    """Log a warning, once per process, if other machines need not get the bits that this process computes."""
    numerics = current()
    if numerics.why_native:
        log.warning("numerics profile native: %s; other machines may get other bits", numerics.why_native)
