"""The motion of the simulated robot as it is."""

from legpush.scene.conventions import TRUNK_QPOS
from sim_proc.control.body_state import BodyState
from sim_proc.headless import mujoco
from sim_proc.physics.sensors import Sensors


def exact_state(data: mujoco.MjData, trunk: int, sensors: Sensors) -> BodyState:
    """Return the state of the robot whose trunk is the body with the index `trunk`.

    Rotation, tips, loads and CoM are those of MuJoCo's last forward computation, up to 2 ms older than the rest.
    """
    rotation = data.xmat[trunk].reshape(3, 3).copy()
    readings = data.sensordata
    return BodyState(
        position_m=data.qpos[TRUNK_QPOS][:3].copy(),
        rotation=rotation,
        velocity_m_s=data.qvel[:3].copy(),
        angular_velocity_rad_s=rotation @ data.qvel[3:6],
        tips_m=sensors.tips_m(readings).copy(),
        loads_n=sensors.loads_n(readings),
        com_m=readings[sensors.of["com"]].copy(),
        com_velocity_m_s=readings[sensors.of["com_velocity"]].copy(),
    )
