"""A launch_testing test that judges the launched base while it drives.

It was run with stand-ins for launch_testing and rclpy, not with ROS.
"""

import time
import unittest
from pathlib import Path

import launch
import launch_ros.actions
import launch_testing.actions
import pytest

import rvmon
from rvmon.adapters.messages import MessageFeed
from rvmon.adapters.ros2 import Ros2Source
from rvmon.live import Live

SPEC = rvmon.load(Path(__file__).parents[1] / "base.rv")
DRIVE_S = 10


@pytest.mark.launch_test
def generate_test_description():
    base = launch_ros.actions.Node(package="base", executable="base")
    return launch.LaunchDescription([base, launch_testing.actions.ReadyToTest()])


class TestBase(unittest.TestCase):
    def test_requirements(self):
        with Live(SPEC) as live, Ros2Source(MessageFeed(live, SPEC.schema)):
            time.sleep(DRIVE_S)
        runs = live.close()
        assert runs, "nothing was heard of the base"
        failed = [str(one) for one in runs[""][0].attempts if one.verdict == "F"]
        assert not failed, "\n".join(failed)
