"""Child processes have the numerics of the profile, whatever the launcher has."""

import pytest

from legpush.errors import PeerError
from legpush.numerics.current import current
from legpush.numerics.profile import VARIABLE
from legpush.processes import child_numerics as module
from legpush.processes.child_numerics import child_numerics


def test_a_child_is_under_the_profile_if_its_parent_was_started_without_it(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in (VARIABLE, "OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "GLIBC_TUNABLES"):
        monkeypatch.delenv(name, raising=False)
    assert child_numerics().startswith("x86-64-v3/")


def test_it_is_what_a_process_under_the_same_environment_has() -> None:
    assert child_numerics() == current().name


def test_a_child_that_fails_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    both = {"NPY_DISABLE_CPU_FEATURES": "X86_V4", "NPY_ENABLE_CPU_FEATURES": "X86_V4"}
    monkeypatch.setattr(module, "child_environment", lambda given: {**given, **both})
    with pytest.raises(PeerError, match="Expected the numerics of a child process, got "):
        child_numerics()
