"""Bindings applied to messages, and faulty bindings."""

import math

import pytest
from tests.tools.bags import DEFINITIONS, START, write_json_mcap, write_ros1, write_ros2
from tests.tools.each import each

import rvmon
from rvmon.errors import RvmonError

pytest.importorskip("rosbags")
pytest.importorskip("mcap")

SPEC = """
spec base
signal speed    : real [m/s]
signal nearest  : real [mm]
signal heading  : real [deg]
signal moving   : bool
signal state.of_base : {idle, busy}
event  near
event  pick(id: int, x: real)

requirement R1
  always speed < 1 m/s
"""

BINDING = """
[bind.speed]
topic = "/base/odom"
value = "1 * hypot(twist.twist.linear.x, twist.twist.linear.y)"  # a scale of its own
unit = "mm/s"

[bind.nearest]
topic = "/base/scan"
value = "min(ranges[0], ranges[1]) - 0.5"
unit = "m"

[bind.heading]
topic = "/base/odom"
value = "yaw(pose.pose.orientation)"
unit = "rad"

[bind.moving]
topic = "/base/odom"
value = "twist.twist.linear.x > 0 and not (twist.twist.linear.x > 2000)"
on = "change"

[bind.state.of_base]
topic = "/base/scan"
value = "state"
labels = { 0 = "idle", 1 = "busy" }

[bind.near]
topic = "/base/scan"
value = "ranges[0] < 1"
on = "change"

[bind.pick]
topic = "/pick"
fields = { id = "id", x = "x / 1000" }
"""


def odom(t, x, y, turn=0.0, late=0):
    stamp = {"sec": (t - late) // 10**9, "nanosec": (t - late) % 10**9}
    half = {"x": 0.0, "y": 0.0, "z": math.sin(turn / 2), "w": math.cos(turn / 2)}
    return (
        "/base/odom",
        t,
        {
            "header": {"stamp": stamp},
            "pose": {"pose": {"orientation": half}},
            "twist": {"twist": {"linear": {"x": x, "y": y}}},
        },
    )


SENT = [
    odom(START, 300.0, 400.0, math.pi / 2, late=5_000_000),
    ("/base/scan", START + 1, {"ranges": [2.0, 3.0], "state": 0}),
    odom(START + 10**7, 600.0, 800.0, late=20_000_000),
    ("/base/scan", START + 10**7 + 1, {"ranges": [0.75, 3.0], "state": 1}),
    ("/base/scan", START + 10**7 + 2, {"ranges": [0.75], "state": 1}),
    ("/pick", START + 2 * 10**7, {"id": 3, "x": 250.0}),
    odom(START + 3 * 10**7, 0.0, 0.0),
]
"""A header is as late as it may be in the second: its stamp is before that of the first."""


@pytest.fixture
def read(tmp_path):
    """The samples of a recording under a binding."""

    def samples(binding=BINDING, sent=SENT, writer=write_ros1, name="a.bag", **options):
        (tmp_path / "base.toml").write_text(binding)
        spec = rvmon.loads(SPEC).reading(binding=tmp_path / "base.toml", **options)
        path = writer(tmp_path / name, sent)
        return [
            (
                one.t - START,
                {n: round(v, 9) if isinstance(v, float) else v for n, v in one.values.items()},
            )
            for one in spec.recording(path)
        ]

    return samples


EXPECTED = [
    (0, {"speed": 0.5, "heading": 90.0, "moving": True}),
    (1, {"nearest": 1500.0, "state.of_base": "idle", "near": False}),
    (10**7, {"speed": 1.0, "heading": 0.0}),
    (10**7 + 1, {"nearest": 250.0, "state.of_base": "busy", "near": True}),
    (10**7 + 2, {"nearest": None, "state.of_base": "busy", "near": False}),
    (2 * 10**7, {"pick": {"id": 3, "x": 0.25}}),
    (3 * 10**7, {"speed": 0.0, "heading": 0.0, "moving": False}),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "writer"),
    [
        ("a.bag", write_ros1),
        ("bag", lambda path, sent: write_ros2(path, sent, "sqlite3")),
        ("bag", lambda path, sent: write_ros2(path, sent, "mcap")),
        ("a.mcap", write_json_mcap),
    ],
)
def test_a_binding_computes_converts_and_notes_changes(read, name, writer):
    assert read(name=name, writer=writer) == EXPECTED


def test_all_elements_of_an_array_count(read):
    """NaN elements are not measurements; without any other the value is unknown."""
    nan, far = float("nan"), float("inf")
    scans = [[2.0, nan, 0.75], [], [nan], [far, far], [3.0]]
    sent = [("/base/scan", START + t, {"ranges": one}) for t, one in enumerate(scans)]
    near = '[bind.nearest]\ntopic = "/base/scan"\nvalue = "min(ranges)"\nunit = "m"\n'
    found = [values["nearest"] for _, values in read(near, sent)]
    assert found == [750.0, None, None, far, 3000.0]
    wrong = near.replace("min(ranges)", "max(state)")
    with pytest.raises(rvmon.TraceError, match=r"has no field `state\[\]`: did you mean `state`"):
        read(wrong, sent, name="b.bag")


def test_what_is_infinite_divided_by_0_is_unknown(read):
    nan, far = float("nan"), float("inf")
    scans = [[far, 0.0], [far, 2.0], [1.0, far], [0.0, 0.0], [far, nan], [-far, far]]
    sent = [("/base/scan", START + t, {"ranges": one}) for t, one in enumerate(scans)]
    ratio = '[bind.nearest]\ntopic = "/base/scan"\nvalue = "ranges[0] / ranges[1]"\n'
    found = [values["nearest"] for _, values in read(ratio, sent)]
    assert found == [None, far, 0.0, None, None, None]


def test_stamps_come_from_headers(read):
    """Stamps of all headers, or for one name; messages are sorted by them."""
    header = BINDING.split("[bind.nearest]")[0]
    odometry = [one for one in SENT if one[0] == "/base/odom"]
    folders = iter("abcdef")

    def stamped(binding, **options):
        return read(binding, odometry, name=f"{next(folders)}.bag", **options)

    found = stamped('clock = "header"\n' + header)
    assert [t for t, _ in found] == [-10_000_000, -5_000_000, 3 * 10**7]
    assert stamped(header, clock="header") == found
    one = header.replace("unit", 'clock = "header"\nunit')
    assert stamped(one) == found
    both = one + '\n[bind.near]\ntopic = "/base/odom"\n'
    assert [t for t, _ in stamped(both)] == [-10_000_000, -5_000_000, 0, 10**7, 3 * 10**7]


def test_messages_without_a_header_need_the_other_clock(read):
    with pytest.raises(rvmon.TraceError, match=r'topic /pick .* no header .*`clock = "log"`'):
        read(clock="header")
    logged = BINDING.replace('topic = "/pick"', 'topic = "/pick"\nclock = "log"')
    found = read(logged, clock="header", name="b.bag")
    assert (2 * 10**7, {"pick": {"id": 3, "x": 0.25}}) in found


@pytest.mark.slow
def test_definitions_that_a_bag_lacks_are_named(read, tmp_path):
    folder = tmp_path / "shop_msgs" / "msg"
    folder.mkdir(parents=True)
    for name in ("Pick", "Scan"):
        (folder / f"{name}.msg").write_text(DEFINITIONS[f"shop_msgs/msg/{name}"])

    def bare(path, sent):
        import apsw

        write_ros2(path, sent, "sqlite3")
        database = apsw.Connection(str(path / f"{path.name}.db3"))
        database.execute("UPDATE schema SET schema_version = 3")
        database.close()
        return path

    with pytest.raises(rvmon.TraceError, match=r"/base/scan .*shop_msgs/msg/Scan.*`definitions`"):
        read(name="bag", writer=bare)
    named = 'definitions = ["shop_msgs/msg/Pick.msg", "shop_msgs/msg/Scan.msg"]\n'
    assert read(named + BINDING, name="bag2", writer=bare) == EXPECTED


@each(
    ("binding", "message"),
    [
        ("bind = [", "no TOML: Invalid value"),
        ('clok = "log"', "no key `clok`: did you mean `clock`"),
        ('clock = "wall"', "clock = 'wall': expected log or header"),
        ("bind.speed = 3", r"\[bind\] `speed`: expected a table"),
        ('[bind.sped]\ntopic="/a"', r"\[bind\.sped\]: nothing named `sped` .* mean `speed`"),
        ('[bind.speed]\nvalue="x"', r"\[bind\.speed\]: which topic feeds it"),
        ('[bind.speed]\ntopic="/a"', "a signal has a value"),
        ('[bind.speed]\ntopic="/a"\nvalue="x"\nunits="m/s"', "no key `units` of a .* `unit`"),
        ('[bind.speed]\ntopic="/a"\nvalue="x"\nunit="mph"', "unknown unit `mph`"),
        ('[bind.speed]\ntopic="/a"\nvalue="x"\nunit="m"', r"\[m\] cannot be converted to \[m/s\]"),
        ('[bind.moving]\ntopic="/a"\nvalue="x"\nunit="m"', "`unit` is for signals that"),
        ('[bind.speed]\ntopic="/a"\nvalue="x +"', r"value = 'x \+': found the end"),
        ('[bind.speed]\ntopic="/a"\nvalue="sinh(x)"', "no function `sinh` in a value"),
        ('[bind.speed]\ntopic="/a"\nvalue="sqrt(x, y)"', "`sqrt` takes 1 numbers, not 2"),
        ('[bind.speed]\ntopic="/a"\nvalue="yaw(x + 1)"', "`yaw` takes a field that"),
        ('[bind.speed]\ntopic="/a"\nvalue="x + 2 m"', "."),
        ('[bind.speed]\ntopic="/a"\nvalue="prev(x)"', "no function `prev` in a value"),
        ('[bind.moving]\ntopic="/a"\nvalue="always x"', "."),
        ('[bind.near]\ntopic="/a"\non="change"', "needs a `value` or `fields`"),
        ('[bind.near]\ntopic="/a"\nfields={x="x"}', "no field `x` is declared: it has none"),
        ('[bind.pick]\ntopic="/a"\nfields={y="x"}', "no field `y` is declared: there are id, x"),
        ('[bind.speed]\ntopic="/a"\nvalue="x"\nlabels={0="a"}', "it is declared real"),
        (
            '[bind.state.of_base]\ntopic="/a"\nvalue="x"\nlabels={0="idel"}',
            "no label `idel` is declared: did you mean `idle`",
        ),
        ('definitions = ["Pick.msg"]', "expected PACKAGE/msg/NAME.msg"),
        ('definitions = ["shop/msg/Pick.msg"]', "No such file"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(tmp_path, binding, message):
    path = tmp_path / "base.toml"
    path.write_text(binding)
    with pytest.raises(RvmonError, match=f"base.toml: .*{message}"):
        rvmon.loads(SPEC).reading(binding=path)


def test_a_topic_that_is_not_there_is_told_with_the_nearest(tmp_path):
    (tmp_path / "base.toml").write_text('[bind.speed]\ntopic = "/base/odm"\nvalue = "x"\n')
    path = write_ros1(tmp_path / "a.bag", SENT)
    spec = rvmon.loads(SPEC).reading(binding=tmp_path / "base.toml")
    with pytest.raises(rvmon.TraceError, match=r"`speed` \(as `/base/odm`\).* mean `/base/odom`"):
        spec.evaluate(path)


def test_a_value_without_a_label_is_told(read):
    with pytest.raises(rvmon.TraceError, match=r"message 2 of /base/scan: `state\.of_base`: no"):
        read(BINDING.replace(', 1 = "busy"', ""))
