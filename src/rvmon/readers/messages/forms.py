"""Which files hold messages; imported by what starts fast, it imports next to nothing."""

from __future__ import annotations

from pathlib import Path

MESSAGE_FORMATS = {".bag": "ros1", ".db3": "ros2", ".mcap": "mcap"}
"""File name endings and the formats of messages they stand for; a bag of ROS 2 is a folder."""


def is_bag_folder(path: str) -> bool:
    """Whether a path is a folder that ROS 2 has recorded."""
    return Path(path, "metadata.yaml").is_file()
