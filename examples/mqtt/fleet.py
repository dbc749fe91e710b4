"""Two bases over MQTT: the left one comes too near and does not stop, the right one stops."""

import sys
import time

from paho.mqtt.client import Client
from paho.mqtt.enums import CallbackAPIVersion

SCENE = [  # seconds, robot, name, value
    (0.0, "left", "speed", "0.8"),
    (0.0, "right", "speed", "0.5"),
    (0.1, "left", "obstacle", "1.0"),
    (0.1, "left", "obstacle", "0.4"),
    (0.2, "left", "stop_request", "true"),
    (0.2, "right", "stop_request", "true"),
    (0.4, "right", "speed", "0.0"),
    (1.5, "right", "obstacle", "2.0"),
]


def main():
    client = Client(CallbackAPIVersion.VERSION2)
    client.connect("localhost", int(sys.argv[1]))
    client.loop_start()
    started = time.monotonic()
    for seconds, robot, name, value in SCENE:
        time.sleep(max(0.0, started + seconds - time.monotonic()))
        client.publish(f"robots/{robot}/{name}", value, qos=1).wait_for_publish()
    client.disconnect()
    client.loop_stop()


if __name__ == "__main__":
    main()
