"""Studies on Ray clusters: two nodes in two network namespaces, tokens, and a node that computes other bits.

Needs root, for the namespaces.
"""

import os
import secrets
import subprocess
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep

import pytest

from tests.system.ray_nodes import CLIENT_PORT, ENVIRONMENT, PORT, Machine, can_have_namespaces, two_machines
from tests.system.studies import begun, require_each_cell_once, rows_of, start_study, write_study

pytestmark = pytest.mark.skipif(not can_have_namespaces(), reason="needs Ray, network namespaces and root")

OTHER_BITS = """
import math
import numpy

def changed(function):
    return lambda *args, **kwargs: function(*args, **kwargs) * (1.0 + 2.0**-40)

for module in (math, numpy):
    for name in ("sin", "cos", "sqrt", "hypot"):
        setattr(module, name, changed(getattr(module, name)))
"""
"""A `sitecustomize` that changes the last bits of a machine's arithmetic."""


@pytest.fixture
def machines() -> Iterator[tuple[Machine, Machine]]:
    with two_machines() as machines:
        yield machines


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment of both machines, with the token of their cluster."""
    file = tmp_path_factory.mktemp("token") / "token"
    file.write_text(secrets.token_hex(32))
    return {**os.environ, **ENVIRONMENT, "RAY_AUTH_TOKEN_PATH": str(file)}


def on_node(head: Machine) -> tuple[str, ...]:
    return ("--on", f"ray:{head.address}:{PORT}")


def as_client(head: Machine) -> tuple[str, ...]:
    return ("--on", f"ray://{head.address}:{CLIENT_PORT}")


def wait_until_begun(folder: Path, n_cells: int, host: str) -> None:
    """Wait until a machine has begun this many cells."""
    deadline_s = monotonic() + 120.0
    while len([mark for mark in (folder / "marks").iterdir() if host in mark.name]) < n_cells:
        assert monotonic() < deadline_s
        sleep(0.05)


def finish(head: "subprocess.Popen[str]", timeout_s: float = 240.0) -> tuple[int, str]:
    output, _ = head.communicate(timeout=timeout_s)
    return head.returncode, output


def test_a_node_that_is_killed_and_brought_back_loses_and_doubles_no_cell(
    machines: tuple[Machine, Machine], environment: dict[str, str], tmp_path: Path
) -> None:
    one, two = machines
    one.start_head(1, environment)
    two.start_node(one, 2, environment)
    write_study(tmp_path, n_cells=150, seconds=0.3)
    head = start_study(tmp_path, *on_node(one), environment=environment, inside=one.inside)
    wait_until_begun(tmp_path, 15, two.name)
    two.kill_all()
    n_before = len([mark for mark in (tmp_path / "marks").iterdir() if two.name in mark.name])
    two.start_node(one, 2, environment)
    code, output = finish(head)

    assert code == 0, output
    assert "A worker of Ray is gone" in output
    require_each_cell_once(tmp_path, 150)
    assert {row["host"] for row in rows_of(tmp_path)} == {one.name, two.name}
    n_after = len([mark for mark in (tmp_path / "marks").iterdir() if two.name in mark.name])
    assert n_after > n_before, "the node was not used again"


def test_a_node_that_computes_other_bits_is_refused_by_name_and_the_rest_of_the_cluster_does_the_study(
    machines: tuple[Machine, Machine], environment: dict[str, str], tmp_path: Path
) -> None:
    one, two = machines
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "sitecustomize.py").write_text(OTHER_BITS)
    path = os.pathsep.join([str(tmp_path / "other"), environment["PYTHONPATH"]])
    one.start_head(1, environment)
    two.start_node(one, 2, {**environment, "PYTHONPATH": path})
    write_study(tmp_path, n_cells=20, seconds=0.2)
    code, output = finish(start_study(tmp_path, *on_node(one), environment=environment, inside=one.inside))

    assert code == 0, output
    assert f"refused a worker on {two.name}: expected the canary" in " ".join(output.split())
    require_each_cell_once(tmp_path, 20)
    assert {row["host"] for row in rows_of(tmp_path)} == {one.name}


def test_a_cluster_is_joined_only_with_its_token_by_nodes_and_by_clients(
    machines: tuple[Machine, Machine], environment: dict[str, str], tmp_path: Path
) -> None:
    one, two = machines
    # The nodes of the cluster find the module of the cells by themselves.
    one.start_head(1, {**environment, "PYTHONPATH": os.pathsep.join([str(tmp_path), environment["PYTHONPATH"]])})
    write_study(tmp_path, n_cells=4, seconds=0.0)
    without = {**environment, "HOME": str(tmp_path)}
    del without["RAY_AUTH_TOKEN_PATH"]
    for on in (on_node(one), as_client(one)):
        for wrong, said in ((without, "token"), ({**without, "RAY_AUTH_TOKEN": "a" * 64}, "got another one")):
            code, output = finish(start_study(tmp_path, *on, environment=wrong, inside=two.inside))
            assert code == 2, output
            assert said in output
    assert begun(tmp_path) == []

    code, output = finish(start_study(tmp_path, *as_client(one), environment=environment, inside=two.inside))
    assert code == 0, output
    require_each_cell_once(tmp_path, 4)


def test_a_cluster_that_asks_for_no_token_is_refused(
    machines: tuple[Machine, Machine], environment: dict[str, str], tmp_path: Path
) -> None:
    one, two = machines
    one.start_head(1, {**environment, "RAY_AUTH_MODE": "disabled"})
    write_study(tmp_path, n_cells=4, seconds=0.0)
    for on, machine in ((on_node(one), one), (as_client(one), two)):
        code, output = finish(start_study(tmp_path, *on, environment=environment, inside=machine.inside))
        assert code == 2, output
        assert "asks for its token" in " ".join(output.split())
    assert begun(tmp_path) == []
