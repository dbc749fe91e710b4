"""Requirements that fail or stay open because of their wording are found, and no others."""

import random
from dataclasses import replace

import pytest
from tests.tools import build
from tests.tools.each import each
from tests.tools.law import judge

from rvmon.diagnostics import Source, Span
from rvmon.language.check.traps import traps_at_start, traps_at_trigger
from rvmon.language.checked.formula import Arithmetic, Constant, Unary, UnaryOp, UpdateValue
from rvmon.language.checked.specification import TimeModel
from rvmon.language.compile import compile_text
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace
from rvmon.testing.law.syntax import numerics
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict

NOWHERE = Span(Source("", ""), 0, 0)


AT_ITS_TRIGGER = {
    "RV047": [
        "upon e then not e unless f",
        "upon e then not e until f",
        "upon e then (not e) until[1 s, 2 s] f",
        "upon e and a then for 2 s not e",
        "upon a then always (b and not a)",
        "upon not a then for 1 s a",
        "upon rise(a) then (not a) unless b",
        "upon fall(a) then a until b",
        "upon held(a, 1 s) then (not a) unless b",
        "upon x > 3 then for 1 s x <= 3",
        "upon x >= 3 then x < 3 until e",
        "upon state == idle then state != idle until e",
        "upon pick.id == 3 then not pick unless e",
        "upon a and (b or (b and c)) then not b until e",
        "always (e -> not e unless f)",
        "whenever known(x) then for 1 s not known(x)",
        "upon e then f M not e",
    ],
    "": [
        "upon e then not f unless e",
        "upon e then always[1 ns, 2 s] not e",
        "upon e then f R[1 ns, inf) (not e)",
        "upon e then within 3 s not e",
        "upon e or f then for 1 s not e",
        "upon a then (not b) until a",
        "upon once e then for 1 s not e",
        "upon not (pick.id == 3) then for 1 s pick.id != 3",
        "upon e then within 1 s (not e unless f)",
        "upon a xor b then for 1 s not a",
    ],
}
"""What the trigger says makes what is required false, but for what ends it at once."""

AT_THE_FIRST_INSTANT = {
    "RV048": [
        "always held(a, 3 s)",
        "always once[1 s, 2 s] a",
        "always (a since[1 ns, 2 s] b)",
        "always ((once[1 s, 2 s] a) or held(b, 1 s))",
        "always not historically[1 s, 2 s] a",
        "always rise(a)",
        "always (b and fall(e))",
        "upon start then held(a, 1 s)",
        "upon start then for 3 s fall(a)",
        "always previous a\ntime sampled",
        "always not not previous a\ntime sampled every 10 ms",
    ],
    "": [
        "always (start or previous a)\ntime sampled",
        "always[3 s, inf) held(a, 3 s)",
        "always once[0 s, 2 s] a",
        "always (a -> held(a, 3 s))",
        "always (start or once[1 ns, 2 s] a)",
        "always (a or held(b, 1 s))",
        "always (a since b)",
        "always within 1 s rise(a)",
        "always held(a, 3 s)\n  scope after (b)",
        "upon a then held(b, 3 s) or c",
    ],
}


@each(
    ("body", "found"),
    [
        (body, found)
        for table in (AT_ITS_TRIGGER, AT_THE_FIRST_INSTANT)
        for found, bodies in table.items()
        for body in bodies
    ],
)
def test_formulas_that_are_false_at_the_start(body, found, codes):
    told = [code for code in codes(f"requirement R {body}\n") if code in ("RV047", "RV048")]
    assert " ".join(told) == found


@each(
    ("text", "found"),
    [
        ("whenever a then for 1 s x <= v let v = x", ["RV049"]),
        ("always (a -> x <= v) let v = x", ["RV049"]),
        ("always x <= v let v = x", ["RV049"]),
        ("whenever e then within 1 s x <= v let v = x", []),
        # In sampled time, consecutive samples with the event are one episode.
        ("whenever e then within 1 s x <= v let v = x\ntime sampled", ["RV049"]),
        ("upon a then for 1 s x <= v let v = x", []),
        ("upon a then for 1 s n <= v let v = pick.id", ["RV028"]),
        ("upon pick or e then for 1 s n <= v let v = pick.id", ["RV028"]),
        ("upon pick.x > 1 m or pick.id == 2 then for 1 s n <= v let v = pick.id + 1", []),
        ("upon pick and a then for 1 s n <= v let v = pick.id", []),
    ],
)
def test_captured_values(text, found, codes):
    """Under `whenever` once per episode; a field only where its event occurs."""
    assert codes(f"requirement R {text}\n") == found


@each("time", ["held", "sampled"])
@each(
    "body",
    [
        "upon e then not e unless f",
        "upon e then not e unless[0, 2 s] f",
        "upon e then (not e) until f",
        "upon a then (not a) until[1 s, 2 s] (b and c)",
        "always held(a, 3 s)",
        "always ((once[1 s, 2 s] a) or held(b, 3 s))",
        "always (a since[1 s, 2 s] b)",
    ],
)
def test_the_proposed_fix_compiles(time, body, codes):
    head = f"time {time}\nsignal a, b, c : bool\nevent e, f\nrequirement R\n  "
    (finding,) = (f for f in compile_text(head + body)[1] if f.code in ("RV047", "RV048"))
    fixed = finding.help.split("`")[1]
    before = body[: body.index("then") + 4] + " " if "then" in body else ""
    assert not {f.code for f in compile_text(head + before + fixed)[1]} & {"RV047", "RV048"}


def required_first():
    """Random past formulas, required at each instant from the first."""
    rng = random.Random(5)
    for _ in range(300):
        spec = random_spec(rng, Profile(future=False, captures=False, for_each=False))
        for requirement in spec.requirements.values():
            part = requirement.consequent
            looked = build.once(part, rng.choice([0, 0, 1, 3]), 4)
            yield spec.time, spec.period, rng.choice([looked, build.held(part, 2), part])


def born(case):
    """The case with every name known in its first sample, as unknown values fail nothing."""
    first = case.samples[0]
    known = {name: value for name, value in first.values.items() if value is not None}
    whole = {**known, "p": True, "q": False, "r": True, "x": 1, "y": 2, "mode": "red"}
    actions = (Sample(first.t, whole), *case.actions[1:])
    return replace(case, actions=actions, names=None)


@pytest.mark.law
def test_warnings_about_the_first_instant_hold_on_every_run():
    warned = 0
    for number, (time, period, required) in enumerate(required_first()):
        requirement = build.requirement(required, whenever=Constant(True))
        parts = (requirement.mode, requirement.trigger, requirement.consequent)
        if isinstance(required, Unary) and required.op in (UnaryOp.RISE, UnaryOp.FALL):
            continue
        if not list(traps_at_start(*parts, NOWHERE)):
            continue
        if any(isinstance(one, UpdateValue | Arithmetic) for one in numerics(required)):
            continue  # its first value comes with the second update, or may never come
        warned += 1
        own = build.spec_of(requirement, time=time, period=period)
        case = random_trace(random.Random(number), own, TraceProfile(advances=False))
        if time is TimeModel.CLOCKED or not case.samples:  # the first position may be later
            continue
        report = judge(born(case))
        assert report.verdicts[requirement.id] is Verdict.FAIL
        assert report.attempts[0].decided == case.samples[0].t
    assert warned > 50


@pytest.mark.law
def test_warnings_about_the_trigger_hold_on_every_run():
    warned = attempts = 0
    for seed in range(1500):
        rng = random.Random(seed)
        spec = random_spec(rng, Profile(captures=False, for_each=False, policies=False))
        said = {
            name
            for name, one in spec.requirements.items()
            for finding in traps_at_trigger(one.trigger, one.consequent, spec.time, NOWHERE)
            if finding.message.endswith("each time")
        }
        warned += len(said)
        for _ in range(8 if said else 0):
            report = judge(random_trace(rng, spec, TraceProfile()))
            mine = [a for a in report.attempts if a.requirement in said]
            attempts += len(mine)
            assert all(a.verdict is not Verdict.PASS for a in mine)
    assert warned > 10
    assert attempts > 50
