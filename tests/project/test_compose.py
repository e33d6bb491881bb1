"""`compose.yaml` follows the compose specification, and gives each service no more than it needs."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from legpush.authority.carry_out import begin
from legpush.bus.secure.certificate_names import CERTIFICATE_ROLES
from legpush.cli.commands import COMMANDS
from tests.project.composed import SECRETS, Service, endpoints, read_compose

ROLES = {"train": "agent", "train-sim": "sim", "study": "agent", "study-worker": "worker"}
"""Certificates of services that are called otherwise."""
WITHOUT_BUS = {"certificates"}
SEEN_BY_ITS_FOLDER = {"study"}
"""Services whose health is read from what they have written."""


@pytest.fixture(scope="module")
def compose(root: Path) -> dict[str, Any]:
    """The whole file."""
    return read_compose(root)


@pytest.fixture(scope="module")
def services(compose: dict[str, Any]) -> dict[str, Service]:
    """The services by their names."""
    found: dict[str, Service] = compose["services"]
    return found


def check(path: Path) -> subprocess.CompletedProcess[str]:
    """Check a file against the published schema of the compose specification, which the checker carries."""
    checker = Path(sys.executable).with_name("check-jsonschema")
    command = [str(checker), "--builtin-schema", "vendor.compose-spec", str(path)]
    return subprocess.run(command, check=False, capture_output=True, text=True)


def role_of(name: str) -> str:
    return ROLES.get(name, name)


def words(service: Service) -> list[str]:
    """The command of a service, word by word, also if a shell reads it."""
    return " ".join(service["command"]).split()


def test_the_file_follows_the_compose_specification(root: Path) -> None:
    assert check(root / "compose.yaml").returncode == 0


def test_a_mistyped_field_would_be_noticed(root: Path, tmp_path: Path) -> None:
    broken = tmp_path / "compose.yaml"
    broken.write_text((root / "compose.yaml").read_text().replace("stop_signal:", "stop_sginal:"))
    assert "stop_sginal" in check(broken).stdout


def test_there_is_a_service_for_each_process_and_all_run_one_image(services: dict[str, Service]) -> None:
    assert {"router", "planner", "sim", "agent"} == {name for name in services if "profiles" not in services[name]}
    assert {"recorder", "viewer", "train", "train-sim", "study", "study-worker", "certificates"} < services.keys()
    assert {(service["image"], service["build"]) for service in services.values()} == {("legpush", ".")}
    for name in ("planner", "sim", "agent"):
        assert services[name]["command"][:3] == ["python", "-m", f"{name}_proc"]
    others = [service["command"] for service in services.values() if service["command"][0] == "legpush"]
    assert {command[1] for command in others} <= COMMANDS.keys()


def test_all_are_clients_of_the_router_which_alone_listens(services: dict[str, Service]) -> None:
    listening = endpoints(services["router"]["command"])
    assert listening == [("0.0.0.0", "17470")]
    for name in services.keys() - {"router", *WITHOUT_BUS}:
        given = words(services[name])
        assert endpoints(given) == [("router", "17470")], name
        assert "--router" in given
        assert not {"--listen", "--connect"} & set(given)


def test_each_service_has_the_certificate_of_its_own_role_and_no_other(
    compose: dict[str, Any], services: dict[str, Service], tmp_path: Path
) -> None:
    """The files are those that the command of the service `certificates` makes, below the folder that it gets."""
    for name in services.keys() - WITHOUT_BUS:
        own = [f"{role_of(name)}.{kind}" for kind in ("pem", "key")]
        assert services[name]["secrets"] == ["authority.pem", "access.json", *own]
        given = words(services[name])
        assert given[given.index("--secure") + 1] == SECRETS
    assert all("secrets" not in services[name] for name in WITHOUT_BUS)
    _, _, _, folder, host, _, router = services["certificates"]["command"]
    begin(tmp_path / "secrets" / "lab", (host,), 1, 1, (router,))
    assert folder == "/secrets/lab"
    made = {path.relative_to(tmp_path) for path in (tmp_path / "secrets" / "lab" / router).iterdir()}
    files = {Path(secret["file"]) for secret in compose["secrets"].values()}
    assert files <= made
    assert {path.stem for path in made - files} == {"launcher"}
    assert all(Path(secret["file"]).name == name for name, secret in compose["secrets"].items())
    assert host.split("=")[1] == "router"


def test_nothing_is_reachable_from_outside_but_the_page_and_that_from_this_machine(
    compose: dict[str, Any], services: dict[str, Service]
) -> None:
    internal = {name for name, network in compose["networks"].items() if network.get("internal")}
    assert compose["networks"].keys() - internal == {"page"}
    for name, service in services.items():
        if name == "viewer":
            assert service["ports"] == ["127.0.0.1:8765:8765"]
        else:
            assert "ports" not in service
            assert set(service["networks"]) <= internal, name
    assert all(services[name]["networks"] == ["alone"] for name in WITHOUT_BUS)


@pytest.mark.parametrize("field", ["user", "read_only", "tmpfs", "cap_drop", "security_opt", "deploy", "healthcheck"])
def test_every_service_is_confined_and_watched(field: str, services: dict[str, Service]) -> None:
    wanted = {
        "user": "1000:1000",
        "read_only": True,
        "tmpfs": ["/tmp"],
        "cap_drop": ["ALL"],
        "security_opt": ["no-new-privileges:true"],
    }
    for name, service in services.items():
        if field == "deploy":
            assert service["deploy"]["resources"]["limits"].keys() == {"cpus", "memory", "pids"}, name
        elif field in wanted:
            assert service[field] == wanted[field], name
        elif name not in WITHOUT_BUS | SEEN_BY_ITS_FOLDER:
            asked = " ".join(service["healthcheck"]["test"]).split()
            asked = asked[asked.index("health") :]
            assert asked[1] == role_of(name)
            assert asked[1] in CERTIFICATE_ROLES
            assert endpoints(asked) == [("router", "17470")]
