"""What the processes have in common: flags, environment, the log, and how an error ends them."""

import logging
import signal
import subprocess
import sys
import threading
from dataclasses import dataclass
from pathlib import Path

import pytest

from legpush import service
from legpush.authority.carry_out import begin
from legpush.bus.bus import Bus
from legpush.bus.endpoints import own_directory
from legpush.errors import (
    ConfigError,
    CredentialsError,
    EndpointError,
    LegpushError,
    PeerError,
    ScenarioError,
    StopRequestedError,
    one_line,
)
from legpush.service import ServiceConfig, parse, run_process


def test_without_flags_a_process_uses_the_sockets_of_its_user() -> None:
    config = parse("agent", ServiceConfig, [], {})
    assert (config.run, config.name, config.inject_faults) == ("local", "main", 0.0)
    assert config.listen == (f"unixsock-stream/{own_directory()}/agent.sock",)
    assert set(config.connect) == {f"unixsock-stream/{own_directory()}/{role}.sock" for role in ("planner", "sim")}


def test_the_environment_gives_defaults_and_flags_overrule_it() -> None:
    env = {"LEGPUSH_RUN": "r1", "LEGPUSH_LISTEN": "tcp/127.0.0.1:1", "LEGPUSH_CONNECT": "tcp/a:2, tcp/b:3"}
    config = parse("sim", ServiceConfig, [], env)
    assert (config.run, config.listen, config.connect) == ("r1", ("tcp/127.0.0.1:1",), ("tcp/a:2", "tcp/b:3"))
    config = parse("sim", ServiceConfig, ["--run", "r2", "--listen", "tcp/c:4", "tcp/d:5", "--connect"], env)
    assert (config.run, config.listen, config.connect) == ("r2", ("tcp/c:4", "tcp/d:5"), ())


def test_a_router_in_the_environment_makes_a_process_its_client_and_flags_overrule_it() -> None:
    env = {"LEGPUSH_ROUTER": "tcp/a:1, tcp/b:2"}
    at = parse("sim", ServiceConfig, [], env).endpoints("sim")
    assert (at.mode, at.listen, at.connect) == ("client", (), ("tcp/a:1", "tcp/b:2"))
    assert parse("sim", ServiceConfig, ["--router", "tcp/c:3"], env).endpoints("sim").connect == ("tcp/c:3",)
    at = parse("sim", ServiceConfig, ["--router"], env).endpoints("sim")
    assert (at.mode, at.listen) == ("peer", (f"unixsock-stream/{own_directory()}/sim.sock",))


def test_a_router_in_the_environment_goes_with_no_other_endpoint() -> None:
    env = {"LEGPUSH_ROUTER": "tcp/a:1"}
    with pytest.raises(EndpointError, match=r"Expected either --router or .*, got --router tcp/a:1 and tcp/b:2"):
        parse("sim", ServiceConfig, ["--connect", "tcp/b:2"], env).endpoints("sim")
    with pytest.raises(EndpointError, match="Expected either --router or"):
        parse("sim", ServiceConfig, [], {**env, "LEGPUSH_LISTEN": "tcp/c:3"}).endpoints("sim")


def test_an_empty_variable_means_no_endpoint() -> None:
    assert parse("agent", ServiceConfig, [], {"LEGPUSH_CONNECT": ""}).connect == ()


@pytest.mark.parametrize("flags", [["--run", "a b"], ["--name", ""], ["--name", "x" * 65], ["--run", "a/b"]])
def test_a_name_that_could_not_be_part_of_a_key_is_refused(flags: list[str]) -> None:
    with pytest.raises(ConfigError, match=f"letters, digits, - or _ for {flags[0]}, got"):
        parse("sim", ServiceConfig, flags, {})


def test_an_endpoint_that_is_none_is_refused() -> None:
    with pytest.raises(EndpointError, match="such as tcp/"):
        parse("sim", ServiceConfig, ["--listen", "here"], {}).endpoints("sim")


def test_faults_with_an_impossible_probability_are_refused() -> None:
    with pytest.raises(ConfigError, match="probability"):
        parse("sim", ServiceConfig, ["--inject-faults", "2"], {}).faults()


@pytest.mark.parametrize("flags", [["--nonsense"], ["--inject-faults", "much"], ["--log-level", "loud"]])
def test_wrong_flags_end_with_code_2(flags: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ending:
        parse("sim", ServiceConfig, flags, {})
    assert ending.value.code == 2
    assert flags[0] in "".join(capsys.readouterr())


@dataclass(frozen=True, kw_only=True)
class OwnConfig(ServiceConfig):
    """A process with a flag of its own."""

    speed: int = 3
    """How fast."""


def test_a_process_can_have_flags_of_its_own() -> None:
    assert parse("agent", OwnConfig, ["--speed", "4"], {}).speed == 4


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (ScenarioError("no box"), 2),
        (ConfigError("no"), 2),
        (PeerError("nobody"), 3),
        (LegpushError("qpos is not finite\nat tick 7"), 3),
        (StopRequestedError("asked to stop"), 130),
    ],
)
def test_an_error_ends_the_process_with_one_line_and_its_code(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], error: LegpushError, code: int
) -> None:
    monkeypatch.setattr(sys, "argv", ["sim", "--listen", "--connect", "--log-level", "error"])
    monkeypatch.setattr(service, "stop_on_signals", threading.Event)

    def work(_: ServiceConfig, __: Bus, ___: threading.Event) -> None:
        raise error

    assert run_process("sim", ServiceConfig, work) == code
    shown = capsys.readouterr().err
    assert shown == f"error: {one_line(str(error))}\n"


def test_what_the_work_returns_is_the_exit_code(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["sim", "--listen", "--connect"])
    monkeypatch.setattr(service, "stop_on_signals", threading.Event)
    assert run_process("sim", ServiceConfig, lambda *_: 1) == 1
    assert run_process("sim", ServiceConfig, lambda *_: None) == 0


def test_a_fault_of_the_process_is_told_from_work_without_success(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["sim", "--listen", "--connect"])
    monkeypatch.setattr(service, "stop_on_signals", threading.Event)

    def work(*_: object) -> int:
        raise ZeroDivisionError("a fault")

    assert run_process("sim", ServiceConfig, work) == 3
    assert "ZeroDivisionError: a fault" in capsys.readouterr().err


def test_a_record_of_the_log_is_one_line_that_says_who_whatever_is_in_it(capsys: pytest.CaptureFixture[str]) -> None:
    root = logging.getLogger()
    before = root.handlers[:], root.level
    try:
        service.start_log("sim/main", "info")
        logging.getLogger("x").warning("a\nb\x1b[31m%s", "ä")
        assert capsys.readouterr().err.endswith("sim/main WARNING a\\nb\\x1b[31mä\n")
    finally:
        root.handlers[:], root.level = before


@pytest.mark.parametrize("module", ["planner_proc", "sim_proc"])
def test_help_needs_no_heavy_library(module: str) -> None:
    script = (
        f"import runpy, sys; sys.argv = ['x', '--help']\n"
        f"try: runpy.run_module({module!r}, run_name='__main__')\n"
        "except SystemExit as ending: assert ending.code == 0\n"
        "heavy = {'ompl', 'mujoco', 'torch', 'scipy'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60.0, check=False)
    assert done.returncode == 0, done.stderr
    assert "--inject-faults" in done.stdout


def test_with_credentials_the_usual_endpoints_are_tls_ports_and_others_stay(tmp_path: Path) -> None:
    begin(tmp_path / "lab", ["robot"], 90, 90)
    secure = ["--secure", str(tmp_path / "lab" / "robot")]
    usual = parse("agent", ServiceConfig, secure, {}).endpoints("agent")
    assert (usual.listen, usual.connect) == (
        ("tls/127.0.0.1:17473",),
        ("tls/127.0.0.1:17471", "tls/127.0.0.1:17472"),
    )
    assert usual.credentials is not None
    assert usual.credentials.name == "agent.robot.1"
    given = parse("sim", ServiceConfig, [*secure, "--listen", "tls/0.0.0.0:1"], {}).endpoints("sim")
    assert given.listen == ("tls/0.0.0.0:1",)
    with pytest.raises(EndpointError, match="Expected endpoints such as tls/"):
        parse("sim", ServiceConfig, [*secure, "--listen", "tcp/0.0.0.0:1"], {}).endpoints("sim")
    with pytest.raises(CredentialsError, match="Expected the folder of a host for --secure"):
        parse("sim", ServiceConfig, ["--secure", str(tmp_path)], {}).endpoints("sim")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_may_come_while_the_main_thread_begins_to_wait_for_it(number: signal.Signals) -> None:
    """It holds the lock of the event then; a handler that wants it would wait for ever."""
    before = {each: signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM)}
    try:
        stop = service.stop_on_signals()
        with stop._cond:  # type: ignore[attr-defined]
            signal.raise_signal(number)
        assert stop.wait(10.0)
        assert signal.getsignal(number) is signal.SIG_DFL
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
