"""Nothing is compiled while an incident runs: numba would keep who waits for the first picture."""

import subprocess
import sys

RUN = """
import sys
from numba.core.dispatcher import Dispatcher
from estimator.measurements.displacement import Displacement
from estimator.measurements.node import Node
from estimator.simulate import scenario
from estimator.trackers.base import TrackerSettings
from estimator.trackers.batch import BatchSmoother
from estimator.trackers.kirchhoff import KirchhoffTracker
from estimator.warm import warm_up
from tests.estimator.inertial.boot_motion import BootMotion

def called():
    modules = [vars(module) for name, module in sys.modules.items() if name.startswith("estimator.")]
    compiled = {one for names in modules for one in names.values() if isinstance(one, Dispatcher)}
    return {(one.py_func.__name__, kinds) for one in compiled for kinds in one.overloads}

warm_up()
before = called()
def follow(readings):
    tracker, seconds = KirchhoffTracker(), {}
    for reading in readings:
        seconds.setdefault(reading.t // 1.0, []).append(reading)
    for second in sorted(seconds):
        tracker.fold(seconds[second])
    tracker.estimates()

smoother = BatchSmoother(TrackerSettings())
early = [reading for reading in scenario("office-fire", 11).readings if reading.t < 40.0]
follow(early)
# Long enough that powers are asked whether a unit's frame has turned.
follow(scenario("paper-a", 0).readings)
# Raw samples of a boot, some of which never came.
samples = BootMotion().rests(5.0).walks(20).rests(3.0).walks(10).gait().readings()
follow([Node(t=0.0, node="ff1", role="responder"), *samples[:12], *samples[13:18], *samples[22:]])
one_step = [
    Node(t=1.0, node="base", role="base", position_m=(0.0, 0.0, 0.0)),
    Node(t=1.0, node="ff1", role="responder"),
    Displacement(t=1.0, node="ff1", delta_m=(3.0, 4.0, 0.0)),
]
for incident, who in ((early, "E7-1"), (one_step, "ff1")):
    smoother.smooth(incident)
    smoother.evidence(incident, who)
    smoother.advice(incident, who)
print(*sorted(f"{name}{kinds}" for name, kinds in called() - before), sep="\\n", end="")
"""


def test_an_incident_calls_nothing_that_was_not_compiled_beforehand() -> None:
    """In a process of its own: what other tests call is not what an incident calls."""
    run = subprocess.run([sys.executable, "-c", RUN], capture_output=True, text=True, check=False)
    assert (run.stdout, run.stderr) == ("", "")
