"""Which engine `--on` names, and what is refused before anything runs."""

import sys
import threading
from pathlib import Path

import pytest

from legpush.errors import ConfigError, StopRequestedError
from legpush.options.study import EngineOptions
from legpush.study.engines.choose import NUMERICS, engine_of, make_engine, require_engine
from legpush.study.engines.local import LocalEngine


@pytest.mark.parametrize("on", ["local", "ray", "ray:head:6379", "ray://head:10001", "slurm"])
def test_engines_that_there_are(on: str) -> None:
    require_engine(on, {})


@pytest.mark.parametrize("on", ["", "Ray", "rays", "dask", "slurm:a", "local:2"])
def test_other_engines_are_refused_with_the_valid_ones(on: str) -> None:
    with pytest.raises(ConfigError, match=r"Expected one of local, inline, ray, .*, slurm for --on"):
        require_engine(on, {})


def test_options_of_slurm_belong_to_slurm() -> None:
    with pytest.raises(ConfigError, match="--slurm-option with --on slurm"):
        require_engine("local", {"time": "5"})


def test_the_local_engine_needs_nothing(tmp_path: Path) -> None:
    engine = make_engine("local", 3, tmp_path, {})
    assert isinstance(engine, LocalEngine)
    assert engine.n_slots() == 3
    engine.close(now=True)


@pytest.mark.parametrize(
    ("on", "extra", "library"), [("ray", "ray", "ray"), ("ray://head:1", "ray", "grpc"), ("slurm", "slurm", "submitit")]
)
def test_an_engine_that_is_not_installed_names_its_extra(
    on: str, extra: str, library: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("ray_cluster", "ray_token", "slurm"):
        monkeypatch.delitem(sys.modules, f"legpush.study.engines.{name}", raising=False)
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ConfigError, match=rf"--on {on} needs {library}, .* pip install 'legpush\[{extra}\]'"):
        make_engine(on, 1, tmp_path, {})


def test_workers_elsewhere_compute_with_the_numerics_of_the_head(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: dict[str, str] = {}
    monkeypatch.setattr(
        "legpush.study.engines.slurm.SlurmEngine.__init__",
        lambda self, study, *, n_jobs, options, environment: given.update(environment),
    )
    for name in NUMERICS:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("OPENBLAS_CORETYPE", "Haswell")
    make_engine("slurm", 1, tmp_path, {})
    assert given["OPENBLAS_CORETYPE"] == "Haswell"
    assert given["OMP_NUM_THREADS"] == "1"
    assert "GLIBC_TUNABLES" not in given


def test_an_engine_that_waits_for_a_router_ends_by_the_stop_of_its_command(tmp_path: Path) -> None:
    stop = threading.Event()
    threading.Timer(0.3, stop.set).start()
    options = EngineOptions(join="lab", router=(f"unixsock-stream/{tmp_path}/nobody.sock",))
    with pytest.raises(StopRequestedError):
        engine_of(options, tmp_path, stop)
