"""The environment of child processes."""

from legpush.processes.environment import child_environment


def test_processes_use_one_thread_per_library_and_keep_the_rest_of_the_environment() -> None:
    environment = child_environment({"HOME": "/home/you", "OMP_NUM_THREADS": "8"})
    assert environment["HOME"] == "/home/you"
    assert environment["OMP_NUM_THREADS"] == environment["OPENBLAS_NUM_THREADS"] == "1"


def test_processes_are_under_the_numerics_profile_unless_the_user_wants_native() -> None:
    assert child_environment({})["LEGPUSH_NUMERICS"] == "x86-64-v3"
    native = child_environment({"LEGPUSH_NUMERICS": "native"})
    assert native["LEGPUSH_NUMERICS"] == "native"
    assert "OPENBLAS_CORETYPE" not in native
