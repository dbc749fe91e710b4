"""Brokers and masters on ports of their own, started and ended by who needs them."""

import os
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

import pytest

LONG = 30.0
"""Seconds in which what was asked to end has to."""

_LOOKS = 10_000
"""So often something is looked for that has to come."""

_LEAST_S, _MOST_S = 0.0005, 0.02
"""Seconds between two looks: more and more, so that waiting takes nothing from what is to come."""

SYSTEM = "/usr/lib/python3/dist-packages"
"""Where Debian has rospy."""

LOOPBACK = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo" multicast="false"/>'
    "</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery>"
    '<ParticipantIndex>auto</ParticipantIndex><Peers><Peer Address="127.0.0.1"/></Peers>'
    "<SPDPInterval>1 s</SPDPInterval></Discovery></Domain></CycloneDDS>"
)
"""`CYCLONEDDS_URI` for processes of this machine alone."""


def mosquitto() -> str | None:
    """The path of the broker, if it is installed."""
    return shutil.which("mosquitto") or shutil.which("/usr/sbin/mosquitto")


def rosmaster() -> str | None:
    """The path of the master of ROS 1, if it is installed with rospy."""
    return shutil.which("rosmaster") if Path(SYSTEM, "rospy").exists() else None


def missing(what: str) -> NoReturn:
    """Do without a test for want of a server; where all is to be installed it fails."""
    if os.environ.get("CI"):
        pytest.fail(f"{what} is not installed")
    pytest.skip(f"{what} is not installed")


def _free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
        return port


def until(true: Callable[[], bool]) -> None:
    """Wait until it is: for three minutes, or longer where the machine has much to do."""
    wait = _LEAST_S
    for _ in range(_LOOKS):
        if true():
            return
        time.sleep(wait)
        wait = min(1.2 * wait, _MOST_S)
    raise TimeoutError("it did not come")


def _started(command: list[str], port: int) -> subprocess.Popen[bytes]:
    """A server that answers at its port."""
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(command, stdout=quiet, stderr=quiet)  # noqa: S603

    def answers() -> bool:
        if process.poll() is not None:
            raise ChildProcessError(f"{command[0]} has ended")
        try:
            socket.create_connection(("127.0.0.1", port)).close()
        except OSError:
            return False
        return True

    until(answers)
    return process


class Broker:
    """A broker of MQTT that can be stopped and started again at its port."""

    def __init__(self, folder: Path) -> None:
        self.port = _free_port()
        self._settings = folder / "mosquitto.conf"
        self._settings.write_text(
            f"listener {self.port} 127.0.0.1\nallow_anonymous true\nsys_interval 1\n"
        )
        self.start()

    def start(self) -> None:
        """Begin, and be there."""
        self._process = _started([str(mosquitto()), "-c", str(self._settings)], self.port)

    def stop(self) -> None:
        """End."""
        self._process.terminate()
        self._process.wait(LONG)


@contextmanager
def master_of_ros1() -> Iterator[str]:
    """The address of a master of ROS 1."""
    port = _free_port()
    process = _started([str(rosmaster()), "--core", "-p", str(port)], port)
    try:
        yield f"http://127.0.0.1:{port}"
    finally:
        process.kill()
        process.wait(LONG)
