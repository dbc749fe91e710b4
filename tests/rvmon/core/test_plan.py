"""Packed plans: their bytes agree with plan.h, and the core checks them."""

import ctypes
import random
import re
import struct
import subprocess
from collections.abc import Iterable
from enum import IntEnum
from itertools import product
from pathlib import Path
from types import SimpleNamespace

import pytest
from tests.rvmon.core.plan_reader import (
    HEADER,
    Plan,
    enumerators,
    layouts,
    record_types,
    size_of,
    size_of_form,
    with_numbers,
)
from tests.tools.each import each

import rvmon
from rvmon.core import sections
from rvmon.core.atoms import DEPTH, MOST_EVENTS, NOW, OPERATIONS, WINDOW, AtomOp, Code
from rvmon.core.nodes import NodeOp
from rvmon.core.obligations import Measure, Operator
from rvmon.core.pack import pack
from rvmon.core.sections import Packed, Section
from rvmon.coverage.monitor import Bins
from rvmon.errors import RvmonError
from rvmon.logic.plan import Plan as Planned
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.packed_plan import planned_core
from rvmon.monitor.requirement_plans import plan_alone
from rvmon.native import sources as core_sources
from rvmon.testing.generate.spec import Profile, random_spec

ROOT = Path(__file__).parents[3]
WRITTEN = [
    *(pytest.param(path, marks=pytest.mark.slow) for path in sorted(ROOT.glob("specs/*.rv"))),
    *sorted(ROOT.glob("examples/**/*.rv")),
]

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic")


EVERYTHING = """
spec everything
time held
signal p, q : bool
signal x : real   stale after 2 s
signal mode : {red, green}
event e(k: int)
event f
requirement R1 upon e.k > 2 and once[1 s, 3 s] p then within 3 s held(q or x > 1, 1 s)
requirement R2 whenever (p since[0 s, 5 s] q) or held(q, 2 s) then within 2 s mode == green
requirement R3 upon rise(p) or changed(x)
  then (abs(delta(x)) < 1 or rate(x) > 2 or prev(x) + 1 > max(x, 2))
    until[0 s, 4 s] (f or not known(x))
requirement R4 upon end then p
requirement R5 upon f then F[0 s, 2 s] once[0 s, 2 s] (q and within 1 s p)
requirement R6 whenever p then within 2 s x > abs(v) + w let v = delta(x) let w = x
requirement R7 upon e and once[0 s, 2 s] e.k == i - 1 then F[0 s, 2 s] once[0 s, 2 s] x > v
  for each i in e.k
  let v = x
"""
"""Something of each kind."""

COUNTED = "signal p : bool\ncoverpoint c = p {yes: true, no: false}\n"
"""A specification without requirements, whose bins are counted."""

DIAGRAM = (
    "spec s\n"
    + "".join(f"signal s{n} : bool\n" for n in range(18))
    + "requirement R\n  upon start\n  then "
    + " or ".join(f"(within {n + 1} s s{n})" for n in range(18))
)
"""A requirement with too many letters for a table."""


def planned(text: str, *, measured: bool = False) -> Planned:
    """The plan of a specification before it is packed."""
    return plan_alone(rvmon.loads(text)._compiled, measured=measured)


def packed(text: str, *, measured: bool = False) -> Packed:
    return pack(planned(text, measured=measured))


def drawn(seed: int) -> Planned | None:
    """The plan of a random specification, measured for odd seeds; `None` if it is refused."""
    try:
        compiled = CompiledSpec(random_spec(random.Random(seed), Profile(many=20)))
        return plan_alone(compiled, measured=seed % 2 == 1)
    except RvmonError:
        return None


@pytest.mark.parametrize("path", WRITTEN, ids=lambda path: path.stem)
def test_the_core_accepts_the_specifications_of_the_repository(path):
    spec = rvmon.load(path)
    planned_core(spec._compiled, measured=True).monitor(frozenset())


def test_automata_of_equal_shape_share_all_but_their_bounds():
    text = "spec s\nsignal p, q, r, s, t, u : bool\n" + "".join(
        f"requirement R{n}\n  upon {a}\n  then within {n + 1} s {b}\n"
        for n, (a, b) in enumerate(("pq", "rs", "tu"))
    )
    texts = text[: text.index("requirement R1")], text
    one, three = (Plan(packed(part).data) for part in texts)
    assert len(three.numbers["INTS"]) == len(one.numbers["INTS"])
    assert len(three.records["AUTOMATA"]) == 3 * len(one.records["AUTOMATA"])
    same = text.replace("within 2 s", "within 1 s").replace("within 3 s", "within 1 s")
    assert len(Plan(packed(same).data).records["AUTOMATA"]) == len(one.records["AUTOMATA"])


CALCULATED = [SimpleNamespace(name=op.name, value=number) for op, number in OPERATIONS.items()]
LAST = [SimpleNamespace(name="NOW", value=NOW), SimpleNamespace(name="WINDOW", value=WINDOW)]


@each(
    ("prefix", "numbers"),
    [
        ("SEC_", Section),
        ("ATOM_", AtomOp),
        ("NODE_", NodeOp),
        ("OP_", Operator),
        ("CODE_", (*Code, *CALCULATED, *LAST)),
        ("MEASURE_", Measure),
    ],
)
def test_enumerators_have_the_same_numbers_in_c(prefix: str, numbers: Iterable[IntEnum]):
    found = {name[len(prefix) :]: n for name, n in enumerators().items() if name.startswith(prefix)}
    assert found == {one.name: one.value for one in numbers}


def test_limits_are_the_same_in_c():
    limits = dict(re.findall(r"#define (\w+) (\d+)\n", HEADER.read_text(encoding="utf-8")))
    assert int(limits["PROGRAM_DEPTH"]) == DEPTH
    assert int(limits["PAYLOAD_EVENTS_MOST"]) == MOST_EVENTS


@pytest.mark.compiler
def test_records_have_the_same_layout_in_c(tmp_path):
    lines = []
    for type_, fields in layouts().items():
        if type_ != "list":
            lines.append(f'printf("{type_} %d\\n", (int)sizeof({type_}));')
            lines += [
                f'printf("{type_}.{own} %d\\n", (int)offsetof({type_}, {own}));'
                for own, _ in fields
            ]
    source = tmp_path / "sizes.c"
    head = '#include <stdio.h>\n#include "plan/plan.h"\nint main(void)\n{\n'
    source.write_text("\n".join([head, *lines, "return 0;\n}\n"]), encoding="utf-8")
    program = tmp_path / "sizes"
    command = ["gcc", *STRICT, f"-I{core_sources.FOLDER}", str(source), "-o", str(program)]
    subprocess.run(command, check=True)  # noqa: S603
    printed = subprocess.run([program], check=True, capture_output=True, text=True)  # noqa: S603
    found = dict(line.split() for line in printed.stdout.splitlines())
    for type_, fields in layouts().items():
        if type_ != "list":
            assert int(found.pop(type_)) == size_of(type_)
            offset = 0
            for own, form in fields:
                assert int(found.pop(f"{type_}.{own}")) == offset
                offset += size_of_form(form)
    assert not found
    for name, type_ in record_types().items():
        assert Section[name].record.size == size_of(type_)


def test_formulas_beyond_the_limits_are_refused():
    def nested(depth: int) -> str:
        deep = "".join("1 + (x * (" for _ in range(depth // 2)) + "x" + "))" * (depth // 2)
        return f"signal x : real\nrequirement R\n  always {deep} > x\n"

    eight = " + ".join(f"e{n}.k" for n in range(8))
    declared = "".join(f"event e{n}(k: int)\n" for n in range(9))
    text = declared + "requirement R\n  always not ({} > 3)\n"
    for taken, refused, why in (
        (nested(30), nested(32), "nested deeper than 31"),
        (text.format(eight), text.format(f"{eight} + e8.k"), "more than 8 events"),
    ):
        rvmon.loads(taken).monitor()
        with pytest.raises(RvmonError, match=why):
            packed(refused)


@pytest.fixture(scope="module")
def check(tmp_path_factory):
    """The core's own check of a plan: returns the number of the wrong section, or −1."""
    library = tmp_path_factory.mktemp("core") / "core.so"
    names = (
        one for one in core_sources.core_files() if one.startswith(("plan/", "input/functions"))
    )
    sources = [f"{core_sources.FOLDER}/{name}" for name in names]
    flags = [
        "-O0",
        "-shared",
        "-fPIC",
        "-fsanitize=undefined",
        "-fsanitize-undefined-trap-on-error",
    ]
    flags.append(f"-I{core_sources.FOLDER}")
    command = ["gcc", *STRICT, *flags, *sources, "-o", str(library), "-lm"]
    subprocess.run(command, check=True)  # noqa: S603
    function = ctypes.CDLL(str(library)).rv_plan_check
    function.argtypes = [ctypes.c_void_p, ctypes.c_size_t]

    def checked(data: bytes) -> int:
        words = (ctypes.c_uint64 * (len(data) // 8)).from_buffer_copy(data)
        return function(ctypes.addressof(words), len(data))

    return checked


@pytest.mark.compiler
@pytest.mark.law
def test_the_core_accepts_packed_plans(check):
    longest = f"spec s\nsignal p : bool\nrequirement R\n  always within {2**62 - 1} ns p\n"
    texts = (EVERYTHING, DIAGRAM, longest)
    assert [check(packed(text).data) for text in texts] == [-1] * 3
    assert [check(packed(text, measured=True).data) for text in texts] == [-1] * 3
    plans = [plan for seed in range(100, 112) if (plan := drawn(seed)) is not None]
    assert [check(pack(plan).data) for plan in plans] == [-1] * len(plans)


@pytest.mark.compiler
def test_the_core_refuses_measures_that_refer_out_of_bounds(check):
    data = packed(EVERYTHING, measured=True).data
    plan = Plan(data)
    for name, skipped in (("MARGINS", {"spare"}), ("MEASURES", {"factor", "turned", "spare"})):
        offset = plan.places[plan.names.index(name)][0]
        for own, form in layouts()[record_types()[name]]:
            end = offset + size_of_form(form)
            places = () if own in skipped else range(offset, end, 4)
            for at, value in product(places, (1 << 30, -7)):
                changed = with_numbers(data, {at: value})
                assert check(changed) == Section.MARGINS, (name, own, value)
            offset = end


@pytest.mark.compiler
def test_one_part_captures_the_values_of_each_requirement(check):
    """Programs that embed the core rely on it to know how many values an attempt has."""
    text = "spec s\nsignal x : real\nevent e\n" + "".join(
        f"requirement R{number}\n  upon e then x > v\n  let v = x\n" for number in range(2)
    )
    data = packed(text).data
    first, end = Plan(data).places[Section.PARTS]
    names = [name for name, _ in layouts()["part_plan"]]
    before = "".join(form for _, form in layouts()["part_plan"][: names.index("requirement")])
    last = end - Section.PARTS.record.size + struct.calcsize(f"={before}")
    assert first < last < end
    assert struct.unpack_from("=i", data, last) == (1,)
    for number, wrong in ((1, -1), (0, Section.PARTS), (2, Section.PARTS)):
        assert check(with_numbers(data, {last: number})) == wrong


@pytest.mark.compiler
def test_a_watch_without_a_link_from_its_node_is_refused(check):
    """It would keep the truth value it had when a snapshot was loaded."""
    data = pack(Bins(rvmon.loads(COUNTED).checked).plan).data
    plan = Plan(data)
    links = [link for link in plan.records["LINKS"] if link["kind"] == 8]
    assert sorted(link["judge"] for link in links) == [0, 1]
    first, end = plan.places[Section.LINKS]
    assert check(data) == -1
    for at in range(first, end, Section.LINKS.record.size):
        (number,) = struct.unpack_from("=i", data, at)
        assert check(with_numbers(data, {at: 1 - number})) == Section.NODES


@pytest.mark.compiler
def test_a_plan_of_too_many_fields_is_refused(check):
    """Their sizes must stay within 32 bits."""
    data = packed("spec s\nsignal p : bool\nevent e(k: int)\nrequirement R\n  always p\n").data
    end = Plan(data).places[Section.FIELD_FIRST][1]
    place = sections.HEADER.size - 4 * 4
    assert struct.unpack_from("=i", data, end - 4) == struct.unpack_from("=i", data, place) == (1,)
    for fields, wrong in ((1 << 20, -1), ((1 << 20) + 1, 0), ((1 << 31) - 1, 0)):
        assert check(with_numbers(data, {end - 4: fields, place: fields})) == wrong


@pytest.mark.compiler
def test_a_nan_constant_is_refused(check):
    text = "spec s\nsignal x, y : real\nrequirement R\n  always x < y + 0.25\n"
    data = packed(text).data
    at = data.index(struct.pack("=d", 0.25), *Plan(data).places[Section.NUMBERS])
    for high, wrong in ((0x7FF00000, -1), (0x7FF80000, Section.NUMBERS), (0x3FE00000, -1)):
        assert check(with_numbers(data, {at: 0, at + 4: high})) == wrong


def test_whole_numbers_beyond_64_bits_are_refused_unless_they_are_doubles():
    text = "spec s\nsignal n : int\nrequirement R\n  always n < {}\n"
    (number,) = Plan(packed(text.format(2**70)).data).records["NUMBERS"][-1:]
    assert number["kind"] == 2
    with pytest.raises(RvmonError, match="more digits"):
        packed(text.format(2**70 + 1))
    (number,) = Plan(packed(text.format(2**63 - 1)).data).records["NUMBERS"][-1:]
    assert number == {"kind": 1, "as": 2**63 - 1}
