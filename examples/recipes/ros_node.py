"""A node of ROS 2 that takes outlines and publishes the twist of the object with its covariance.

    python examples/recipes/ros_node.py --ros-args -p units_per_metre:=350.0

It subscribes to `outline` (`geometry_msgs/PolygonStamped`: one closed contour, image units) and publishes `twist`
(`geometry_msgs/TwistWithCovarianceStamped`) in metres and seconds. The camera looks straight down on the plane of motion.

A twist belongs to a point, which is here the middle of the object, and to a frame of axes: those of the outlines, x to the right and y
up. Turns are counterclockwise in ROS and clockwise in this package, so that `angular.z = -omega`.
"""

from typing import Any

import numpy as np

import freeform_motion as ff

#: The variance of what a planar motion does not have, and of what is not known. ROS has no word for "unknown"; estimators such as
#: robot_localization take a large variance for it.
NONE, UNKNOWN = 0.0, 1e9


def twist_of(motion_filter: ff.MotionFilter, units_per_metre: float) -> tuple[list[float], np.ndarray] | None:
    """Twist of the middle of the object and its covariance, in the order of ROS.

    Returns
    -------
    twist : list of float
        vx, vy, vz in m/s, then wx, wy, wz in rad/s.
    covariance : ndarray of shape (6, 6)
        In the same order. An angular velocity that the outlines do not show is 0 with the variance `UNKNOWN`.
    """
    velocity, state, estimate = motion_filter.velocity, motion_filter.state, motion_filter.estimate
    if velocity is None or estimate is None:
        return None
    twist, covariance = [0.0] * 6, np.full((6, 6), NONE)
    twist[:2] = [float(v) / units_per_metre for v in velocity.velocity]
    covariance[:2, :2] = velocity.covariance / units_per_metre**2
    omega = estimate["omega"].value
    if omega is None or state is None:
        covariance[5, 5] = UNKNOWN
        return twist, covariance
    twist[5] = -omega
    # The velocity at (x, y) is (b1 + omega y, b2 - omega x). An error of the pose, which begins the covariance, shifts that point.
    x, y = velocity.point
    by_motion = np.array([[y, 1.0, 0.0], [-x, 0.0, 1.0]])
    by_pose = np.array([[0.0, omega], [-omega, 0.0]]) @ by_motion
    jacobian = np.zeros((3, 6))
    jacobian[:2] = np.hstack([by_pose, by_motion]) / units_per_metre
    jacobian[2, 3] = -1.0
    known = [0, 1, 5]
    covariance[np.ix_(known, known)] = jacobian @ state.covariance @ jacobian.T
    return twist, covariance


def fill(message: Any, header: Any, twist: list[float], covariance: np.ndarray) -> Any:
    """A TwistWithCovarianceStamped with these values."""
    message.header = header
    linear, angular = message.twist.twist.linear, message.twist.twist.angular
    linear.x, linear.y, linear.z, angular.x, angular.y, angular.z = twist
    message.twist.covariance = [float(value) for value in covariance.ravel()]
    return message


def points_of(polygon: Any) -> np.ndarray:
    """The points of a `geometry_msgs/Polygon`, of shape (n, 2)."""
    return np.array([(point.x, point.y) for point in polygon.points], dtype=np.float64).reshape(-1, 2)


def seconds_of(stamp: Any) -> float:
    """A `builtin_interfaces/Time` in seconds."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def main() -> None:
    import rclpy
    from geometry_msgs.msg import PolygonStamped, TwistWithCovarianceStamped
    from rclpy.node import Node

    class OutlineMotion(Node):
        def __init__(self) -> None:
            super().__init__("outline_motion")
            self.units = self.declare_parameter("units_per_metre", 1.0).value
            self.motion_filter, self.start = ff.MotionFilter(), None
            self.publisher = self.create_publisher(TwistWithCovarianceStamped, "twist", 10)
            self.create_subscription(PolygonStamped, "outline", self.take, 10)

        def take(self, message: Any) -> None:
            time = seconds_of(message.header.stamp)
            # Times since the epoch leave a double too few digits for short intervals.
            self.start = time if self.start is None else self.start
            try:
                step = self.motion_filter.step(time - self.start, points_of(message.polygon))
            except ValueError as error:
                self.get_logger().warning(str(error))
                return
            if not step.is_accepted:
                self.get_logger().warning(f"frame not used: {step.rejection}")
                return
            found = twist_of(self.motion_filter, self.units)
            if found is not None:
                self.publisher.publish(fill(TwistWithCovarianceStamped(), message.header, *found))

    rclpy.init()
    rclpy.spin(OutlineMotion())


if __name__ == "__main__":
    main()
