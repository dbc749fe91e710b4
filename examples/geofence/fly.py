"""A drone in the wind: verdicts while it flies, and afterwards its margin to the fence."""

import sys
from pathlib import Path

import rvmon

HERE = Path(__file__).parent
STEP_S, FASTEST = 0.1, 4.0  # s; m/s relative to the air


def flight(wind):
    """Samples of a flight to a point 40 m in the east and back; the wind is from the west, m/s."""
    x, height, battery, goal = 0.0, 0.0, 1.0, 40.0
    for step in range(800):
        values = {"x": x, "y": 0.0, "height": height, "battery": battery}
        if step and height == 0.0:
            yield step * STEP_S, {**values, "landed": True}
            return
        yield step * STEP_S, values
        goal = 0.0 if x > 35.0 or battery < 0.25 else goal
        lands = goal == 0.0 and x < 5.0
        x += STEP_S * (max(-FASTEST, min(FASTEST, goal - x)) + wind)
        height = max(0.0, height - 0.1) if lands else min(10.0, height + 0.2)
        battery -= 0.0015


def main(wind):
    spec = rvmon.load(HERE / "fence.rv")
    monitor = spec.monitor()
    for t, values in flight(wind):
        for attempt in monitor.step(t, values):  # on a real drone, in the callback of positions
            print(attempt)
    for name, verdict in monitor.finish().verdicts.items():
        print(name, verdict)
    margin = spec.robustness(flight(wind)).attempts["G1", 1]
    print(f"to the fence: {margin.kept:.1f} m")


if __name__ == "__main__":
    main(float(sys.argv[1]))
