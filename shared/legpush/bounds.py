"""The bounds of numbers in messages, scenarios and options, each with its reason, and the types that have them.

What is beyond is refused where a message, a file or a command line is read, before anything moves. The simulator was
tried at the bounds: robots pushed and walked there, and neither MuJoCo nor anything else warned. Texts, bytes and
arrays have a bound of their own where many of them would slow down a process; otherwise the largest size of a message
bounds them, see `legpush.messages.codec`.
"""

from typing import Annotated, Final

from msgspec import Meta

MAX_COUNT: Final = 2**53
"""Largest count: up to here readers of JSON keep every integer."""
MAX_TEXT: Final = 10_000
"""Most characters of a description: it travels with every `Reset`."""
MAX_TIME_NS: Final = 2**63 - 1
"""Latest time in nanoseconds since 1970, in the year 2262: the largest integer that every MessagePack library has."""
MAX_TIME_S: Final = 1e6
"""Longest simulated time, 11 days: longer than any mission."""
MAX_COORDINATE_M: Final = 1e7
"""Farthest place from the origin, along an axis: that of the grids of maps. Here a float64 still resolves 2e-9 m."""
MAX_YAW_RAD: Final = 1e3
"""Largest heading. One that was never wrapped may count many turns."""
MAX_READING: Final = 1e10
"""Largest measurement, in its SI unit: MuJoCo's `mjMAXVAL`, above which it takes a state for unstable."""
MAX_QUATERNION: Final = 1.001
"""Largest component of a unit quaternion, with rounding."""
MAX_PATH_M: Final = 1e13
"""Longest path, more than 100 000 waypoints at coordinates within their bounds can have."""

LEAST_LENGTH_M: Final = 1e-6
MAX_LENGTH_M: Final = 1e3
"""Least and largest length in a scenario: nothing that a robot of 1 m does is finer, and a room of 1000 m takes 2500
gait cycles to cross.
"""
MAX_MARGIN_M: Final = 100.0
"""Largest clearance: wider than any passage."""
MAX_FACTOR: Final = 100.0
"""Largest multiple of a turning radius."""
LEAST_ANGLE_DEG: Final = 1e-6
MAX_TURN_DEG: Final = 360.0
"""Least angle that has to be above 0, and a full turn."""
MAX_SLOPE_DEG: Final = 10.0
"""Steepest floor, twice as steep as those of the studies."""
LEAST_RESOLUTION_M: Final = 0.001
MAX_RESOLUTION_M: Final = 100.0
"""Side of the cells of a map: a grid of 4096 x 4096 cells covers 4 m, or reaches 400 km."""
LEAST_THICKNESS_M: Final = 1e-4
"""Thinnest obstacle. MuJoCo refuses geoms without a size, and the least cell of a map is ten times as wide."""
MAX_OBSTACLES: Final = 10_000
"""Most obstacles of a room: side by side they take seconds to build, and then no time."""
MAX_OVERLAP: Final = 20
"""Most obstacles that share a place. A robot in 100 of them takes 10 s for a push; 1000 overflow MuJoCo's arena."""
MAX_APPEARING: Final = 100
"""Most obstacles that appear later: at every tick the simulator looks whether the place of each is clear. More than
2000 of them overflow MuJoCo's arena.
"""
LEAST_BOX_SIDE_M: Final = 0.01
MAX_BOX_SIDE_M: Final = 10.0
"""Side of the box: a quarter of the diameter of a foot, or so wide that the foot cannot reach the contact point."""
LARGEST_LOAD: Final = 0.9
"""Largest share of the mass of a box that lies in one place, so that the rest has a mass and an inertia of its own."""
LEAST_BOX_MASS_KG: Final = 0.001
MAX_BOX_MASS_KG: Final = 1000.0
"""Mass of the box. The robot weighs 32 kg and moves at most 100 kg."""
LEAST_FRICTION: Final = 1e-5
MAX_FRICTION: Final = 10.0
"""Friction of the box: MuJoCo's `mjMINMU`, and more than any dry contact has."""
MAX_DEPTH_M: Final = 0.25
"""Deepest push, five times as deep as the usual one."""
LEAST_BODY_M: Final = 0.001
MAX_BODY_M: Final = 10.0
"""Length of a part of the robot, from a foot of an insect to ten times the robot's own size."""
LEAST_PART_KG: Final = 0.001
MAX_PART_KG: Final = 1000.0
"""Mass of a part of the robot, as that of the box."""
MAX_JOINT_DEG: Final = 180.0
"""Largest joint angle either way."""
LEAST_GAIN_N_M_RAD: Final = 0.01
MAX_GAIN_N_M_RAD: Final = 1e6
"""Position gain of a servo. Below, legs carry nothing; above, a joint is as stiff as steel."""
MAX_VELOCITY_GAIN_N_M_S_RAD: Final = 1e5
"""Velocity gain of a servo, and viscous damping of a joint."""
LEAST_TORQUE_N_M: Final = 0.001
MAX_TORQUE_N_M: Final = 1e5
"""Largest torque of a servo."""
MAX_ARMATURE_KG_M2: Final = 100.0
"""Rotor inertia, a hundred times that of a leg."""
LEAST_TICKS: Final = 2
MAX_TICKS: Final = 100
"""Duration of a part of a step: half of the least is one tick, and a plan over the next four steps takes a second."""
MAX_STEP_TURN_RAD: Final = 1.5
"""Largest change of heading in a gait cycle, nearly a quarter turn."""
LEAST_TILT_DEG: Final = 1.0
MAX_TILT_DEG: Final = 90.0
"""Tilt of a robot that has fallen: at the least it may not sway, and at the most it lies on its side."""
LEAST_JOINT_SPEED_RAD_S: Final = 0.1
MAX_JOINT_SPEED_RAD_S: Final = 1e3
"""Largest speed of a joint."""
MAX_TORQUE_POINTS: Final = 200
"""Most rows of a table of torques by angle."""
MAX_LANDING_SPEED_M_S: Final = 1.0
"""Fastest landing of a foot: a fall from 5 cm."""
MAX_REACH_MARGIN_DEG: Final = 30.0
"""Largest margin to the limits of a joint, half of the smallest range."""
MAX_STATION_TURN_DEG: Final = 90.0
"""Largest turn from the robot to a place that it can still step to."""
MAX_SIDE_SHARE: Final = 0.5
"""Farthest contact point from the middle of a face: at its edge."""
MAX_WAYPOINTS: Final = 100_000
"""Most poses of a path: at 0.05 m from one to the next, 5 km."""
LEAST_WAYPOINTS: Final = 10
"""Least number of waypoints that a smooth path is limited to."""
MAX_CELLS: Final = 4096 * 4096
"""Most cells of a grid: a quarter of the largest message."""
MAX_ITERATIONS: Final = 10_000_000
"""Largest budget of a search: it takes minutes to hours."""
MAX_SHORT_ITERATIONS: Final = 1_000_000
"""The same, where an iteration takes longer or there are many searches."""
MAX_IMPROVEMENTS: Final = 1000
"""Most better paths that a planner sends for one query."""
MAX_PUSH_CYCLES: Final = 10_000
"""Most pushes of a mission, eight hours of simulated time."""
MAX_CALIBRATION_PUSHES: Final = 40
"""Most pushes that measure a box: they move it 2.4 m."""
LEAST_DEVIATION_M: Final = 0.01
"""Least deviation that a smoothed path may be limited to: the robot does not step more precisely."""
MAX_ARC_DEG: Final = 720.0
"""Longest arc of a reference, two turns."""
LEAST_WAVELENGTH_M: Final = 0.01
"""Shortest wave of a reference: the distance between two of its points."""
LEAST_PERIODS: Final = 0.01
MAX_PERIODS: Final = 20.0
"""Number of waves of a reference, which is no longer than `MAX_LENGTH_M` in all."""
LEAST_WAIT_S: Final = 1e-3
"""Shortest time to wait for something, of a clock on the wall; the longest one is `MAX_TIME_S`."""
LEAST_SPEED: Final = 1e-3
MAX_SPEED: Final = 1e6
"""Slowest and fastest way to play a recording, as a multiple of its own speed."""
LEAST_FPS: Final = 0.1
MAX_FPS: Final = 1000.0
"""Frames per second of a film: two per control period are 100."""
LEAST_FILE_MB: Final = 0.001
MAX_FILE_MB: Final = 1e6
"""Size of a part of a recording, up to 1 TB."""
MAX_SIMULATORS: Final = 256
"""Most simulators of a learner: each is a process that takes 90 MB."""
MAX_VALID_DAYS: Final = 36_500
"""Longest time for which a certificate is valid, in days: a century."""

Count = Annotated[int, Meta(ge=0, le=MAX_COUNT)]
Crc = Annotated[int, Meta(ge=0, le=2**32 - 1)]
Amount = Annotated[int, Meta(ge=1, le=MAX_COUNT)]
"""A count of at least one."""
TimeNs = Annotated[int, Meta(ge=0, le=MAX_TIME_NS)]
"""A time in nanoseconds since 1970; it takes more than 53 bits."""
TimeS = Annotated[float, Meta(ge=0.0, le=MAX_TIME_S)]
Unit = Annotated[float, Meta(ge=0.0, le=1.0)]
Coordinate = Annotated[float, Meta(ge=-MAX_COORDINATE_M, le=MAX_COORDINATE_M)]
Yaw = Annotated[float, Meta(ge=-MAX_YAW_RAD, le=MAX_YAW_RAD)]
Reading = Annotated[float, Meta(ge=-MAX_READING, le=MAX_READING)]
"""A measurement, or a number that people look at."""
QuaternionPart = Annotated[float, Meta(ge=-MAX_QUATERNION, le=MAX_QUATERNION)]
PathLength = Annotated[float, Meta(ge=0.0, le=MAX_PATH_M)]
Length = Annotated[float, Meta(ge=LEAST_LENGTH_M, le=MAX_LENGTH_M)]
"""A length in a scenario that has to be above 0."""
Distance = Annotated[float, Meta(ge=0.0, le=MAX_LENGTH_M)]
"""A length in a scenario that may be 0."""
Margin = Annotated[float, Meta(ge=0.0, le=MAX_MARGIN_M)]
QueryLength = Annotated[float, Meta(ge=LEAST_LENGTH_M, le=MAX_COORDINATE_M)]
"""A length in a query, which may be a multiple of one in a scenario, above 0."""
QueryDistance = Annotated[float, Meta(ge=0.0, le=MAX_COORDINATE_M)]
"""The same, which may be 0."""
Resolution = Annotated[float, Meta(ge=LEAST_RESOLUTION_M, le=MAX_RESOLUTION_M)]
Degrees = Annotated[float, Meta(ge=-MAX_TURN_DEG, le=MAX_TURN_DEG)]
"""A heading in degrees, as people write it."""
Turn = Annotated[float, Meta(ge=0.0, le=MAX_TURN_DEG)]
"""The size of a turn in degrees."""
AngleTolerance = Annotated[float, Meta(ge=LEAST_ANGLE_DEG, le=MAX_TURN_DEG)]
"""In degrees."""
Slope = Annotated[float, Meta(ge=0.0, le=MAX_SLOPE_DEG)]
"""In degrees."""
BoxSide = Annotated[float, Meta(ge=LEAST_BOX_SIDE_M, le=MAX_BOX_SIDE_M)]
BoxOffset = Annotated[float, Meta(ge=-MAX_BOX_SIDE_M, le=MAX_BOX_SIDE_M)]
"""A place in the box along an axis."""
BoxMass = Annotated[float, Meta(ge=LEAST_BOX_MASS_KG, le=MAX_BOX_MASS_KG)]
Friction = Annotated[float, Meta(ge=LEAST_FRICTION, le=MAX_FRICTION)]

BodyLength = Annotated[float, Meta(ge=LEAST_BODY_M, le=MAX_BODY_M)]
"""A length of the robot that has to be above 0."""
BodyDistance = Annotated[float, Meta(ge=0.0, le=MAX_BODY_M)]
"""A length of the robot that may be 0."""
PartMass = Annotated[float, Meta(ge=LEAST_PART_KG, le=MAX_PART_KG)]
JointAngle = Annotated[float, Meta(ge=-MAX_JOINT_DEG, le=MAX_JOINT_DEG)]
"""In degrees."""
KneeAngle = Annotated[float, Meta(ge=0.0, le=MAX_JOINT_DEG)]
"""In degrees."""
PositionGain = Annotated[float, Meta(ge=LEAST_GAIN_N_M_RAD, le=MAX_GAIN_N_M_RAD)]
VelocityGain = Annotated[float, Meta(ge=0.0, le=MAX_VELOCITY_GAIN_N_M_S_RAD)]
Damping = Annotated[float, Meta(ge=0.0, le=MAX_VELOCITY_GAIN_N_M_S_RAD)]
Torque = Annotated[float, Meta(ge=LEAST_TORQUE_N_M, le=MAX_TORQUE_N_M)]
JointSpeed = Annotated[float, Meta(ge=LEAST_JOINT_SPEED_RAD_S, le=MAX_JOINT_SPEED_RAD_S)]
LandingSpeed = Annotated[float, Meta(ge=0.0, le=MAX_LANDING_SPEED_M_S)]
Armature = Annotated[float, Meta(ge=0.0, le=MAX_ARMATURE_KG_M2)]
Ticks = Annotated[int, Meta(ge=LEAST_TICKS, le=MAX_TICKS)]
StepTurn = Annotated[float, Meta(ge=LEAST_LENGTH_M, le=MAX_STEP_TURN_RAD)]
"""In radians."""
FallTilt = Annotated[float, Meta(ge=LEAST_TILT_DEG, le=MAX_TILT_DEG)]
"""In degrees."""
StationTurn = Annotated[float, Meta(ge=LEAST_ANGLE_DEG, le=MAX_STATION_TURN_DEG)]
"""In degrees."""
ReachMargin = Annotated[float, Meta(ge=0.0, le=MAX_REACH_MARGIN_DEG)]
"""In degrees."""
SideShare = Annotated[float, Meta(ge=0.0, le=MAX_SIDE_SHARE)]

Depth = Annotated[float, Meta(ge=0.0, le=MAX_DEPTH_M)]
"""How deep a push is."""
TurnRad = Annotated[float, Meta(ge=0.0, le=MAX_YAW_RAD)]
"""The size of a turn."""
Cells = Annotated[int, Meta(ge=1, le=MAX_CELLS)]
Waypoints = Annotated[int, Meta(ge=LEAST_WAYPOINTS, le=MAX_WAYPOINTS)]
Iterations = Annotated[int, Meta(ge=1, le=MAX_ITERATIONS)]
ShortIterations = Annotated[int, Meta(ge=1, le=MAX_SHORT_ITERATIONS)]
Improvements = Annotated[int, Meta(ge=1, le=MAX_IMPROVEMENTS)]
PushCycles = Annotated[int, Meta(ge=1, le=MAX_PUSH_CYCLES)]
CalibrationPushes = Annotated[int, Meta(ge=0, le=MAX_CALIBRATION_PUSHES)]
Deviation = Annotated[float, Meta(ge=LEAST_DEVIATION_M, le=MAX_LENGTH_M)]
Reserve = Annotated[float, Meta(ge=1.0, le=MAX_FACTOR)]
"""A multiple that leaves room for corrections."""
Arc = Annotated[float, Meta(ge=LEAST_ANGLE_DEG, le=MAX_ARC_DEG)]
"""In degrees."""
Wavelength = Annotated[float, Meta(ge=LEAST_WAVELENGTH_M, le=MAX_LENGTH_M)]
Periods = Annotated[float, Meta(ge=LEAST_PERIODS, le=MAX_PERIODS)]
WaitS = Annotated[float, Meta(ge=LEAST_WAIT_S, le=MAX_TIME_S)]
Speed = Annotated[float, Meta(ge=LEAST_SPEED, le=MAX_SPEED)]
FramesPerSecond = Annotated[float, Meta(ge=LEAST_FPS, le=MAX_FPS)]
FileMegabytes = Annotated[float, Meta(ge=LEAST_FILE_MB, le=MAX_FILE_MB)]
Simulators = Annotated[int, Meta(ge=1, le=MAX_SIMULATORS)]
ValidDays = Annotated[int, Meta(ge=1, le=MAX_VALID_DAYS)]
