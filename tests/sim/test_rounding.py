"""Equal motions lead to equal states, however many threads the numerical libraries were given."""

import os
import subprocess
import sys

SCRIPT = """
from math import cos, sin
import numpy
from legpush.geometry import Pose2
from legpush.messages.stepping import Follow, Push, Reset, Walk
from legpush.scenarios.file import load_scenario
from sim_proc.simulator import Simulator

def after(scenario, *motions):
    simulator = Simulator()
    return [simulator.perform(m, with_trace=False).state_crc for m in (Reset(scenario=scenario, seed=1), *motions)][-1]

push = Push(w1=0.5, w2=0.3, leg="FL", depth_m=0.05)
scenario = load_scenario("default")
start = scenario.start.pose()
ahead = [start @ Pose2(x_m=sin(a), y_m=1 - cos(a), yaw_rad=a) for a in numpy.linspace(0, 0.5, 20)]
print(after(load_scenario("push"), push, push), after(scenario, Follow(waypoints=tuple(ahead)), Walk(), Walk()))
"""


def test_threads_of_the_numerical_libraries_change_no_bit() -> None:
    crcs = set()
    for n_threads in ("1", "2"):
        environment = {**os.environ, **{f"{name}_NUM_THREADS": n_threads for name in ("OMP", "OPENBLAS")}}
        command = [sys.executable, "-c", SCRIPT]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=200)
        crcs.add(done.stdout)
    assert len(crcs) == 1
    assert "0" not in crcs.pop().split()
