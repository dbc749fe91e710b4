"""What may be wrong with the sensors; by default nothing."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

Sensor = Literal["gaze", "pressure", "location", "distance"]


class SensorFaults(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Imperfections of the sensors.

    Attributes:
        noise_m: standard deviation of every measured length, metres.
        delay_s: age of what the robot reads of gaze, pressure and location, seconds.
        dropout: sensors that are dead: the robot gets no reading, the signal is unknown.
    """

    noise_m: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    delay_s: Annotated[float, msgspec.Meta(ge=0, le=10)] = 0.0
    dropout: tuple[Sensor, ...] = ()
