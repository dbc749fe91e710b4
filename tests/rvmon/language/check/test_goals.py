"""Cover goals, coverpoints and crosses."""

from tests.tools.each import each

from rvmon.language.checked.properties import BinKind
from rvmon.language.print import format_formula


def bins(checked, text):
    point = checked(f"coverpoint p {text}").coverpoints["p"]
    return {bin_.name: format_formula(bin_.formula) for bin_ in point.bins}


@each(
    ("text", "expected"),
    [
        ("= a {yes: true, no: false}", {"yes": "a", "no": "not a"}),
        ("= state {idle, go: moving}", {"idle": "state == idle", "go": "state == moving"}),
        ("= n {zero: 0, one: 1}", {"zero": "n == 0", "one": "n == 1"}),
        (
            "= d {near: [0 m, 50 cm), far: [50 cm, inf)}",
            {"near": "d >= 0 m and d < 0.5 m", "far": "d >= 0.5 m"},
        ),
        ("= d {fast: speed > 1 m/s}", {"fast": "speed > 1 m/s"}),
        ("= state {go: idle => moving}", {"go": "rise(state == moving) and prev(state) == idle"}),
        ("= a {off: true => false}", {"off": "rise(not a) and prev(a)"}),
        ("{x: a and once b, y: e}", {"x": "a and once b", "y": "e"}),
    ],
)
def test_bins_are_formulas(checked, text, expected):
    assert bins(checked, text) == expected


def test_clauses(checked):
    spec = checked(
        "coverpoint p = a {yes: true, illegal no: false} upon e goal 3 weight 0\n"
        "coverpoint q = b {yes: true}\ncross c = p, q weight 3\ncross d = p, q upon f"
    )
    point, crosses = spec.coverpoints["p"], spec.crosses
    assert (format_formula(point.upon), point.goal, point.weight) == ("e", 3, 0)
    assert [bin_.kind for bin_ in point.bins] == [BinKind.GOAL, BinKind.ILLEGAL]
    assert crosses["c"].weight == 3
    assert [format_formula(cross.upon) for cross in crosses.values()] == ["e", "f"]


def test_cross(checked):
    spec = checked(
        "coverpoint p = a {yes: true, no: false}\ncoverpoint q = state {idle, moving}\n"
        "cross c = p, q\n  ignore p == no and q == idle\n  illegal p == no <-> q != idle\n  goal 2"
    )
    cross = spec.crosses["c"]
    assert (cross.points, cross.goal) == (("p", "q"), 2)
    assert cross.ignored == {("no", "idle")}
    assert cross.illegal == {("no", "moving"), ("yes", "idle")}


MANY = ", ".join(f"b{number}: {number}" for number in range(101))


@each(
    ("text", "codes_found"),
    [
        ("coverpoint p = a {yes}", ["RV060"]),
        ("coverpoint p {yes: 3}", ["RV060"]),
        ("coverpoint p {low: [0, 5)}", ["RV060"]),
        ("coverpoint p {up: false => true}", ["RV060"]),
        ("coverpoint p = a {yes: F b}", ["RV060"]),
        ("coverpoint p = a {yes: true} upon F b", ["RV060"]),
        ("coverpoint p = a {yes: true} goal 0", ["RV060"]),
        ("coverpoint p = a {yes: true} ignore a", ["RV060"]),
        ("coverpoint p = a {yes: true, yes: false}", ["RV011"]),
        ("coverpoint p = state {stopped}", ["RV013"]),
        ("coverpoint p = d {near: [0 m, 3 s]}", ["RV022"]),
        ("coverpoint p = d {near: 3}", ["RV023"]),
        ("coverpoint p = aa {yes: true}\ncross c = p", ["RV012"]),
        ("coverpoint p = a {yes: true}\ncross c = p, p", ["RV061"]),
        ("cross c = p", ["RV061"]),
        ("coverpoint p = a {yes: true}\ncross c = p ignore a", ["RV061"]),
        ("coverpoint p = a {yes: true}\ncross c = p ignore p == maybe", ["RV013"]),
        ("coverpoint p = state {x: idle => idle}", ["RV060"]),
        ("coverpoint p = x + 1 {y: 1 => 2}", ["RV021"]),
        ("coverpoint p = a {yes: true} weight 1.5", ["RV060"]),
        (
            "coverpoint p = a {y: true} upon e\ncoverpoint q = a {y: true} upon b\ncross c = p, q",
            ["RV061"],
        ),
        ("cover C = aa", ["RV012"]),
        ("cover C = end", ["RV041"]),
        ("cover C = a\nrequirement C always a", ["RV011"]),
        (f"coverpoint p = n {{{MANY}}}\ncoverpoint q = x {{{MANY}}}\ncross c = p, q", ["RV061"]),
    ],
)
def test_goals_that_are_refused(codes, text, codes_found):
    assert codes(text) == codes_found


@each(
    ("text", "empty"),
    [
        ("= x {b: [5, 3]}", True),
        ("= x {b: (2, 2]}", True),
        ("= x {b: [2, 2], c: (2, 3), illegal d: [3, inf)}", False),
        ("= d {b: [1 m, 50 cm)}", True),
        ("= d {b: [100 cm, 1 m]}", False),
        ("= n {b: (2, 3)}", True),
        ("= n {b: 2.5}", True),
        ("= n {b: (2, 4), c: [3, 3], d: (1, 3)}", False),
        ("= n {b: x > 5}", False),
        ("= x {b: x == 2 and x > 1, c: x != 2 and x >= 2}", False),
        ("= x {b: x == 2 and x != 2}", True),
        ("= state {idle, moving}", False),
    ],
)
def test_bins_that_nothing_can_hit(codes, text, empty):
    assert codes(f"coverpoint p {text}") == (["RV062"] if empty else [])
