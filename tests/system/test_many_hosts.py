"""A training with simulators on other hosts, two of them in one process, through a router and over TLS."""

import sys
from contextlib import ExitStack
from pathlib import Path
from time import sleep
from typing import Final

from tests.security.hosts import made
from tests.system.machines import HUB, NEEDS_ROOT, on, plug, said, three_machines
from tests.system.missions import LEGPUSH, LIMIT_S

ROOT: Final = Path(__file__).parents[2]
LEARNER: Final = ["env", f"PYTHONPATH={ROOT}", sys.executable, "-m", "tests.system.small_learner"]
PORT: Final = 17470
CUT_OFF_S: Final = 20.0


def simulator(name: str, host: str, lab: Path, n: int = 1) -> list[str]:
    """The words that start a process of `n` simulators of the training on a host."""
    at = f"tls/{HUB[host]}:{PORT}"
    return [
        sys.executable,
        "-P",
        "-m",
        "sim_proc",
        "--run",
        "learn",
        "--name",
        name,
        "--simulators",
        str(n),
        "--router",
        at,
        *secure(lab, host),
    ]


def secure(lab: Path, host: str) -> list[str]:
    """The option with the folder of a host."""
    return ["--secure", str(lab / host)]


@NEEDS_ROOT
def test_a_training_on_two_hosts_of_which_one_is_cut_off_and_one_loses_a_simulator_has_the_same_weights(
    tmp_path: Path,
) -> None:
    lab = made(tmp_path / "lab", f"hub={','.join(HUB.values())}", *HUB, routers=("hub",)).parent
    logs = {name: tmp_path / f"{name}.log" for name in ("alone", "router", "a", "c", "d", "e", "learner")}
    with ExitStack() as stack:
        stack.enter_context(three_machines())
        alone = on(stack, "hub", logs["alone"], LEARNER)
        routing = [*LEGPUSH, "router", "--listen", f"tls/0.0.0.0:{PORT}", *secure(lab, "hub")]
        on(stack, "hub", logs["router"], routing)
        assert alone.wait(LIMIT_S) == 0, logs["alone"].read_text()
        running = {
            name: on(stack, host, logs[name], simulator(name, host, lab, n))
            for name, host, n in (("a", "robot", 2), ("c", "desk", 1), ("d", "desk", 1))
        }
        joining = ["--join", "learn", "--simulators", "4", "--router", f"tls/127.0.0.1:{PORT}", *secure(lab, "hub")]
        learner = on(stack, "hub", logs["learner"], [*LEARNER, *joining])

        assert said(logs["learner"], "^1$"), logs["learner"].read_text()
        plug("robot", in_place=False)
        sleep(CUT_OFF_S)
        assert "3" not in logs["learner"].read_text().splitlines(), "it waits for the host that is cut off"
        plug("robot", in_place=True)
        assert said(logs["learner"], "^3$"), logs["learner"].read_text()
        running["d"].kill()
        on(stack, "desk", logs["e"], simulator("e", "desk", lab))

        assert learner.wait(LIMIT_S) == 0, logs["learner"].read_text()
    assert "is asked alone" not in logs["learner"].read_text()
    weights = logs["alone"].read_text().splitlines()[-1]
    assert weights.startswith("weights ")
    assert logs["learner"].read_text().splitlines()[-1] == weights
