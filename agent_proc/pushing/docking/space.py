"""Where a box near its goal, and the robot that pushes it, have space."""

from math import hypot

from legpush.geometry import Pose2
from legpush.scene.clearance import Occupied
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.footprints import Footprint, box_footprint, robot_footprint
from legpush.scene.names import Face
from legpush.scene.occupancy import occupancy_grid
from legpush.scene.scenario import Scenario
from legpush.scene.station import station


class DockSpace:
    """The space around the goal of a room."""

    def __init__(self, scenario: Scenario, box: Pose2, reach_m: float) -> None:
        """`reach_m` is how far from its goal the box may be; a box at `box` may stay as near to things as it is."""
        self.room = scenario.room
        self._scenario = scenario
        self._goal = scenario.goal.pose.pose()
        self._occupied = Occupied(occupancy_grid(scenario.room))
        length_m, width_m, _ = scenario.box.size_m
        body = robot_footprint(scenario.robot, Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0))
        behind_m = max(length_m, width_m) / 2 + scenario.robot.station_m + hypot(body.length_m, body.width_m)
        side_m = 2 * (reach_m + max(behind_m, hypot(length_m, width_m) / 2) + scenario.pushing.margin_m)
        self._is_open = self._occupied.distance_m(Footprint(pose=self._goal, length_m=side_m, width_m=side_m)) > 0.0
        self._margin_m = scenario.pushing.margin_m
        self._box_margin_m = min(self._margin_m, self._occupied.distance_m(box_footprint(scenario.box, box)))

    def is_free(self, box: Pose2, face: Face) -> bool:
        """Return whether a box, in the frame of the goal, and the robot that pushes it at a face have space."""
        if self._is_open:
            return True
        scenario, pose = self._scenario, self._goal @ box
        if self._occupied.distance_m(box_footprint(scenario.box, pose)) < self._box_margin_m:
            return False
        trunk = station(scenario.robot, pushed_box(scenario.box, face), pushed_pose(pose, face))
        return self._occupied.distance_m(robot_footprint(scenario.robot, trunk)) >= self._margin_m
