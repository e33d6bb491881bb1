"""Push maps of the fake world."""

from agent_proc.push_model.calibration import cell_samples, cells
from agent_proc.push_model.map import PushMap, make_push_map, measured_faces
from agent_proc.push_model.model import NOMINAL
from legpush.scene.scenario import Box
from tests.agent.fake_world import FakeWorld
from tests.robots import ROBOT

DEPTHS_M = (0.02, 0.05)


def measured(box: Box = NOMINAL, push_scale: float = 1.0, curves: tuple[float, ...] = (0.5,)) -> PushMap:
    """A map of what the fake world does."""
    world = FakeWorld(push_scale=push_scale)
    planned = cells(measured_faces(box), [(w, w) for w in curves], DEPTHS_M, (1, 2))
    samples = [sample for cell in planned for sample in cell_samples(world, ROBOT, box, cell)]
    return make_push_map(box, samples, "test")
