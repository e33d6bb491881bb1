"""The sensors of the MuJoCo model."""

from typing import Any, Final

from legpush.scene.conventions import FRONT_LEGS, JOINTS, LEGS
from sim_proc.headless import mujoco

NET_FORCE: Final = 3
"""Reduction `netforce` of MuJoCo's contact sensor: the sum of all contacts as one."""


def add_sensors(spec: mujoco.MjSpec, *, ground: str | None) -> None:
    """Add sensors: forces on the feet, an IMU, joints, the robot's centre of mass, and numbers of contacts.

    `ground` is the body of the floor, if it is one.
    """
    surface = "floor" if ground is None else ground
    surface_kind = mujoco.mjtObj.mjOBJ_GEOM if ground is None else mujoco.mjtObj.mjOBJ_BODY

    def contact_force(name: str, foot: str, other: str, of_kind: mujoco.mjtObj) -> None:
        """Net force of a geom or body on a foot: MuJoCo's contact sensor with data `force` and reduction `netforce`."""
        spec.add_sensor(
            name=name,
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=mujoco.mjtObj.mjOBJ_GEOM,
            objname=foot,
            reftype=of_kind,
            refname=other,
            intprm=[1 << int(mujoco.mjtConDataField.mjCONDATA_FORCE), NET_FORCE, 1],
        )

    def n_contacts(name: str, **between: Any) -> None:
        """The number of contacts, of all or of those between two things."""
        spec.add_sensor(
            name=name,
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            intprm=[1 << int(mujoco.mjtConDataField.mjCONDATA_FOUND), 0, 1],
            **between,
        )

    for leg in LEGS:
        contact_force(f"{leg}_floor_force", f"{leg}_foot", surface, surface_kind)
    for leg in LEGS:
        contact_force(f"{leg}_box_force", f"{leg}_foot", "box", mujoco.mjtObj.mjOBJ_BODY)
    imu = {"objtype": mujoco.mjtObj.mjOBJ_SITE, "objname": "imu"}
    spec.add_sensor(name="imu_orientation", type=mujoco.mjtSensor.mjSENS_FRAMEQUAT, **imu)
    spec.add_sensor(name="imu_angular_velocity", type=mujoco.mjtSensor.mjSENS_GYRO, **imu)
    spec.add_sensor(name="imu_acceleration", type=mujoco.mjtSensor.mjSENS_ACCELEROMETER, **imu)
    trunk = {"objtype": mujoco.mjtObj.mjOBJ_BODY, "objname": "trunk"}
    spec.add_sensor(name="com_velocity", type=mujoco.mjtSensor.mjSENS_SUBTREELINVEL, **trunk)
    for leg in LEGS:
        tip = {"objtype": mujoco.mjtObj.mjOBJ_SITE, "objname": f"{leg}_tip"}
        spec.add_sensor(name=f"{leg}_tip", type=mujoco.mjtSensor.mjSENS_FRAMEPOS, **tip)
    joints = [f"{leg}_{joint}" for leg in LEGS for joint in JOINTS]
    for what, kind, sensed in (
        ("position", mujoco.mjtSensor.mjSENS_JOINTPOS, mujoco.mjtObj.mjOBJ_JOINT),
        ("velocity", mujoco.mjtSensor.mjSENS_JOINTVEL, mujoco.mjtObj.mjOBJ_JOINT),
        ("torque", mujoco.mjtSensor.mjSENS_ACTUATORFRC, mujoco.mjtObj.mjOBJ_ACTUATOR),
    ):
        for name in joints:
            spec.add_sensor(name=f"{name}_{what}", type=kind, objtype=sensed, objname=name)
    spec.add_sensor(
        name="com", type=mujoco.mjtSensor.mjSENS_SUBTREECOM, objtype=mujoco.mjtObj.mjOBJ_BODY, objname="trunk"
    )
    for leg in LEGS:
        spec.add_sensor(
            name=f"{leg}_foot_force",
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=mujoco.mjtObj.mjOBJ_GEOM,
            objname=f"{leg}_foot",
            intprm=[1 << int(mujoco.mjtConDataField.mjCONDATA_FORCE), NET_FORCE, 1],
        )
    box, floor = (
        {"objtype": mujoco.mjtObj.mjOBJ_BODY, "objname": "box"},
        {"reftype": surface_kind, "refname": surface},
    )
    for leg in LEGS:
        n_contacts(f"{leg}_floor_contacts", objtype=mujoco.mjtObj.mjOBJ_GEOM, objname=f"{leg}_foot", **floor)
    n_contacts("box_floor_contacts", **box, **floor)
    for leg in FRONT_LEGS:
        foot = {"reftype": mujoco.mjtObj.mjOBJ_GEOM, "refname": f"{leg}_foot"}
        n_contacts(f"{leg}_box_contacts", **box, **foot)
    n_contacts("contacts")
    # MuJoCo's own accelerometer has the acceleration before that is damped implicitly: its sum is not the velocity.
    spec.add_sensor(
        name="imu_velocity", type=mujoco.mjtSensor.mjSENS_FRAMELINVEL, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="imu"
    )
