"""Elements of arrays that are addressed by name."""

import pytest
from tests.tools.bags import START, write_json_mcap, write_ros1

import rvmon
from rvmon.recordings.recording import FileRecording

pytest.importorskip("rosbags")
pytest.importorskip("mcap")

TYPES = {
    "/joints": "sensor_msgs/msg/JointState",
    "/arm/state": "control_msgs/msg/State",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/dynamic": "control_msgs/msg/DynamicJointState",
}
OWN = {
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms\n",
    "control_msgs/msg/State": "string[] joint_names\ncontrol_msgs/Point actual\n"
    + "=" * 80
    + "\nMSG: control_msgs/Point\nfloat64[] positions\n",
    "control_msgs/msg/DynamicJointState": "string[] joint_names\n"
    "control_msgs/InterfaceValue[] interface_values\n"
    + "=" * 80
    + "\nMSG: control_msgs/InterfaceValue\nstring[] interface_names\nfloat64[] values\n",
}
VALUES = [{"key": "Mode", "value": "on"}, {"key": "Load (%)", "value": "41.5"}]
SENT = [
    ("/joints", START, {"name": ["elbow", "wrist"], "position": [1.0, 2.0]}),
    ("/joints", START + 1, {"name": ["finger"], "position": [9.0]}),
    ("/joints", START + 2, {"name": ["wrist", "elbow"], "position": [3.0, 4.0]}),
    ("/joints", START + 3, {"name": ["wrist", "elbow"], "position": [5.0]}),
    ("/arm/state", START + 4, {"joint_names": ["a", "b"], "actual": {"positions": [6.0, 7.0]}}),
    (
        "/diagnostics",
        START + 5,
        {"status": [{"name": "left motor", "level": 1, "values": VALUES}]},
    ),
    (
        "/tf",
        START + 6,
        {"transforms": [{"child_frame_id": "hand", "transform": {"translation": {"x": 8.0}}}]},
    ),
    (
        "/dynamic",
        START + 7,
        {
            "joint_names": ["a", "b"],
            "interface_values": [
                {"interface_names": ["position"], "values": [0.5]},
                {"interface_names": ["position", "effort"], "values": [1.5, 2.5]},
            ],
        },
    ),
]
PLACES = {
    "elbow": ("/joints", "position[elbow]"),
    "b": ("/arm/state", "actual.positions[b]"),
    "level": ("/diagnostics", "status[left motor].level"),
    "mode": ("/diagnostics", "status[left motor].values[Mode].value"),
    "load": ("/diagnostics", "number(status[left motor].values[Load (%)].value) + 1"),
    "nothing": ("/diagnostics", "number(status[left motor].values[Mode].value)"),
    "hand": ("/tf", "transforms[hand].transform.translation.x"),
    "effort": ("/dynamic", "interface_values[b].values[effort] * 2"),
}
SPEC = """
spec s
signal elbow, b, hand, effort, load, nothing : real
signal level : int
signal mode : {on, off}
"""


def values(path, binding=None, columns=None):
    spec = rvmon.loads(SPEC + "requirement R1\n  always true\n")
    reading = spec.reading(binding=binding, columns=columns or {})
    samples = FileRecording(path, reading.schema)
    return [(one.t - START, dict(one.values)) for one in samples if one.values]


@pytest.fixture
def bound(tmp_path):
    """A binding by names."""
    path = tmp_path / "a.toml"
    tables = [
        f'[bind.{name}]\ntopic = "{topic}"\nvalue = "{value}"\n'
        for name, (topic, value) in PLACES.items()
    ]
    path.write_text("\n".join(tables))
    return path


@pytest.mark.slow
@pytest.mark.parametrize("form", ["bag", "mcap"])
def test_names_lead_to_elements(tmp_path, bound, form):
    """At any index; a message without the name does not update the signal."""
    if form == "bag":
        path = write_ros1(tmp_path / "a.bag", SENT, TYPES, OWN)
    else:
        path = write_json_mcap(tmp_path / "a.mcap", SENT)
    assert values(path, bound) == [
        (0, {"elbow": 1.0}),
        (2, {"elbow": 4.0}),
        (3, {"elbow": None}),
        (4, {"b": 7.0}),
        (5, {"level": 1, "mode": "on", "load": 42.5, "nothing": None}),
        (6, {"hand": 8.0}),
        (7, {"effort": 5.0}),
    ]


def test_a_name_may_be_mapped(tmp_path):
    """Like an element with an index."""
    path = write_ros1(tmp_path / "a.bag", SENT[:1], TYPES, OWN)
    assert values(path, columns={"elbow": "/joints.position[wrist]"}) == [(0, {"elbow": 2.0})]


@pytest.mark.parametrize(
    ("topic", "value", "message"),
    [
        (
            "/diagnostics",
            "number(status[left motor].level)",
            "is not text, and `number` reads text",
        ),
        ("/diagnostics", "number(status[left motor].lefel)", "did you mean `status"),
        ("/diagnostics", "status[left motor].values[Mode].value", "holds text"),
        ("/joints", "header[elbow].seq", "no field `header"),
    ],
)
def test_texts_and_numbers_are_told_apart(tmp_path, bound, topic, value, message):
    bound.write_text(f'[bind.load]\ntopic = "{topic}"\nvalue = "{value}"\n')
    path = write_ros1(tmp_path / "a.bag", SENT, TYPES, OWN)
    with pytest.raises(rvmon.TraceError, match=message):
        values(path, bound)
