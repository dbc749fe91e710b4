"""The vocabulary of names, topics and fields: synonyms, modifiers, quantities and units."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence, Set

from rvmon.units import Unit, parse_unit

Dimension = tuple[tuple[str, int], ...]

_SYNONYMS = {
    "speed": "velocity vel velocities groundspd spd",
    "acceleration": "acc accel accelerometer accelerations",
    "command": "cmd commanded commands setpoint desired des target goal reference ref teleop",
    "distance": "dist range ranges",
    "current": "curr",
    "vibration": "vibe",
    "temperature": "temp temperatures thermistor",
    "voltage": "volt volts",
    "latitude": "lat",
    "longitude": "lon lng long",
    "altitude": "alt",
    "battery": "batt bat bms",
    "yaw": "heading hdg theta",
    "position": "pos positions",
    "relative": "rel",
    "satellites": "satellite sats nsats sat sv svs",
    "percentage": "percent pct soc",
    "remaining": "rem",
    "number": "num nr count",
    "torque": "torques",
    "wheel": "wheels",
    "motor": "motors",
    "minimum": "min least smallest",
    "maximum": "max greatest largest",
    "magnetometer": "mag magnetic compass",
    "front": "fore",
    "rear": "back behind",
    "illuminance": "brightness luminance lux",
    "status": "state",
    "estop": "emergencystop estopped",
    "barometer": "baro barometric",
    "innovation": "innovations innov",
    "integral": "integ",
    "variance": "var variances",
}
"""Synonyms by canonical word."""

_CANONICAL = {word: one for one, words in _SYNONYMS.items() for word in words.split()}


def _set(*lines: str) -> frozenset[str]:
    return frozenset(word for line in lines for word in line.split())


_WORD = re.compile(r"[A-Z]+(?![^\W\d_A-Z])|[A-Z]?[^\W\d_A-Z]+|\d+")

_COMPOUNDS = {
    **{f"v{axis}": ("speed", axis) for axis in "xyz"},
    **{f"a{axis}": ("acceleration", axis) for axis in "xyz"},
    "groundspeed": ("ground", "speed"),
    "airspeed": ("air", "speed"),
    "yawspeed": ("yaw", "rate"),
    "yawrate": ("yaw", "rate"),
    "rollspeed": ("roll", "rate"),
    "pitchspeed": ("pitch", "rate"),
    "cpuload": ("cpu", "load"),
    "wp": ("waypoint",),
    "xtrack": ("cross", "track"),
    "crosstrack": ("cross", "track"),
    "aspd": ("air", "speed"),
    "vservo": ("servo", "voltage"),
    "vcc": ("board", "voltage"),
}
"""Compounds and abbreviations, split into words."""

_OF_PLACES = _set("altitude latitude longitude timestamp x y z")
"""Quantities whose reference is an origin; for others, `ref` means a command."""

EMPTY = _set(
    "a actual at base body data has in is it joint measured msg my of on own robot self",
    "sensor signal the value vehicle values ego reading link frame fmu out travel driving",
)
"""Words without meaning for the match."""

PLACES = _set("base body frame link joint fmu")
"""The words of `EMPTY` that are meaningful if a field has no other word."""

WEAK = frozenset({"imu", "ground", "horizontal"})
"""Words that need not be found if there is no foreign word."""

MODIFIERS = _set(
    "command error tolerance limit minimum maximum offset bias variance accuracy delta",
    "reset counter design time timestamp stamp increment last home initial origin average",
    "mean derivative integral raw scaling covariance confidence quality valid health",
    "full nominal rated input output",
    "fault failsafe failure innovation drift index id device",
)
"""Words that turn a quantity into another one."""

OF_TOPICS = _set("innovation variance bias error drift home origin")
"""The words of `MODIFIERS` that apply to all fields if they are in the name of a topic."""

OF_COMMENTS = OF_TOPICS | _set("accuracy covariance limit tolerance")
"""The modifiers that apply if they are in a comment."""

SUBJECTS = _set(
    "wind water air person pedestrian human people obstacle object ball door target lead other",
    "engine motor fan pump thruster propeller gimbal load fuel cpu gpu ambient external internal",
    "gripper hand finger trailer fork lift manual stick",
)
"""Subjects other than the robot as a whole; their quantities are not the robot's."""

OF_SURROUNDINGS = frozenset({"humidity", "illuminance"})
"""Quantities of the surroundings, never of a part of the robot."""

ORDINALS = {
    **dict.fromkeys(("leader", "lead", "first", "master", "primary"), "1"),
    **dict.fromkeys(("follower", "second", "slave", "secondary"), "2"),
}
"""Words for the first and the second of several."""

_QUANTITIES = {
    word: units
    for units, words in {
        "m/s rad/s": "speed",
        "m/s": "climb",
        "m": "distance clearance obstacle gap height altitude depth length width radius x y z",
        "m rad": "position",
        "rad": "yaw roll pitch tilt angle course bearing steering latitude longitude",
        "rad/s": "gyro rpm",
        "m/s^2 rad/s^2": "acceleration",
        "N": "force",
        "N 1": "thrust",
        "N*m": "torque",
        "N*m N": "effort",
        "degC K": "temperature",
        "V": "voltage",
        "A": "current",
        "A*s 1": "charge",
        "W": "power",
        "J": "energy",
        "Pa": "pressure",
        "Hz": "frequency",
        "Hz rad/s m/s": "rate",
        "kg": "mass payload",
        "kg N": "weight",
        "1": "percentage ratio scaling humidity throttle",
        "lx": "illuminance",
        "s": "duration age",
        "m^2": "area",
        "m^3": "volume",
        "m^3/s": "flow",
        "T": "magnetometer",
    }.items()
    for word in words.split()
}
"""Units by quantity word."""

AXES = ("x", "y", "z")

_TELLING = frozenset({"degC K", "V", "A", "W", "J", "Pa", "N"})
"""Units that identify a single quantity."""

_TURNING = frozenset({"angular", "yaw", "turn", "turning", "roll", "pitch", "gyro", "steering"})

_ENDINGS = (
    "m_s2=m/s^2 m_s=m/s mps=m/s kmh=km/h kph=km/h rad_s=rad/s deg_s=deg/s rad=rad deg=deg rpm=rpm "
    "hz=Hz mm=mm cm=cm m=m ms=ms s=s mv=mV v=V ma=mA a=A w=W pa=Pa celsius=degC degc=degC "
    "percent=% pct=% kg=kg"
)
"""Units by the ending of a name after a `_`, the longest first."""


def words_of(text: str) -> list[str]:
    """Split a name, a topic or a path into words, and replace each by its canonical word.

    >>> words_of("/robot1/handDistance.twist_vx"), words_of("e_stop")
    (['robot', '1', 'hand', 'distance', 'twist', 'speed', 'x'], ['estop'])
    >>> words_of("ref_alt"), words_of("speed_ref"), words_of("climb_rate")
    (['origin', 'altitude'], ['speed', 'command'], ['climb'])
    """
    plain = re.sub(r"(?i)\b(e|emergency)[_ ]?stop(ped)?(?![a-z])", "estop", text.replace("_", " "))
    found = [word.casefold() for word in _WORD.findall(plain)]
    split = [part for word in found for part in _COMPOUNDS.get(word, (word,))]
    words = [_CANONICAL.get(word, word) for word in split]
    if found[0:1] in (["ref"], ["reference"]) and not _OF_PLACES.isdisjoint(words[1:2]):
        words[0] = "origin"
    return [
        "rate" if word == "speed" and before in ("yaw", "roll", "pitch") else word
        for before, word in zip(["", *words], words, strict=False)
        if (before, word) != ("climb", "rate")
    ]


def is_found(word: str, there: Iterable[str]) -> bool:
    """Whether a word is among others, also in singular or plural: `wheel` and `wheels`."""
    return any(
        word == one or (min(len(word), len(one)) > 3 and one.rstrip("s") == word.rstrip("s"))
        for one in there
    )


def parts_of(word: str, known: Set[str]) -> list[str]:
    """Split a compound word if both parts are known words.

    >>> parts_of("handbrake", {"hand", "brake"}), parts_of("brake", {"hand", "brake"})
    (['hand', 'brake'], ['brake'])
    """
    cuts = range(3, len(word) - 2) if word not in known else ()
    both = ([word[:cut], word[cut:]] for cut in cuts)
    return next((two for two in both if known >= {*two}), [word])


def is_measured_in(word: str, unit: Unit) -> bool:
    """Whether a word names the only quantity that is measured in such a unit.

    >>> is_measured_in("voltage", parse_unit("mV")), is_measured_in("speed", parse_unit("m/s"))
    (True, False)
    """
    plain = _QUANTITIES.get(word, "")
    return plain in _TELLING and parse_unit(plain.split()[0]).dimension == unit.dimension


def dimensions_of(words: Sequence[str]) -> frozenset[Dimension]:
    """The possible dimensions of a quantity, by the last word that names one; empty if none does.

    >>> sorted(map(str, dimensions_of(["yaw", "rate"]))), dimensions_of(["mode"])
    (["(('rad', 1), ('s', -1))"], frozenset())
    """
    for word in reversed(words):
        units = _QUANTITIES.get(word, "").split()
        if word in ("speed", "rate", "acceleration") and not _TURNING.isdisjoint(words):
            units = ["rad/s^2" if word == "acceleration" else "rad/s"]
        elif word in ("speed", "acceleration") and "linear" in words:
            units = units[:1]
        elif word == "x" or word == "y" or word == "z":
            others = [one for one in words if one not in AXES and one not in EMPTY]
            if others:
                return dimensions_of(others)
        if units:
            return frozenset(parse_unit(unit).dimension for unit in units)
    return frozenset()


def unit_in_name(field: str) -> str:
    """The unit at the end of a field's name, such as `speed_m_s`; "" if there is none.

    >>> unit_in_name("true_airspeed_m_s"), unit_in_name("batteryPercent"), unit_in_name("pose.x")
    ('m/s', '%', '')
    """
    last = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", field.rpartition(".")[2]).casefold()
    known = (pair.partition("=") for pair in _ENDINGS.split())
    return next((unit for end, _, unit in known if last.endswith(f"_{end}")), "")
