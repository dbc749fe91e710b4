"""Requirements: normal forms, pulses, warnings, clauses."""

import pytest
from tests.tools.each import each

from rvmon.language.checked.specification import EndPolicy, Mode, RunShare
from rvmon.language.print import format_formula


@each(
    ("text", "mode", "trigger", "consequent"),
    [
        ("always (a -> b)", "whenever", "a", "b"),
        ("always (a -> eventually b)", "whenever", "a", "eventually b"),
        ("always always a", "whenever", "true", "a"),
        ("always (a -> b -> c)", "whenever", "a and b", "c"),
        ("always (a -> (F b) -> c)", "whenever", "a", "(eventually b) -> c"),
        ("always ((F a) -> b)", "whenever", "true", "(eventually a) -> b"),
        ("(always a) and always b", "whenever", "true", "a and b"),
        ("always (a) and always (always b)", "whenever", "true", "a and b"),
        ("(always a) and eventually b", "upon", "start", "(always a) and eventually b"),
        ("for 3 s a", "upon", "start", "for 3 s a"),
        ("always[1 s, inf) a", "upon", "start", "always[1 s, inf) a"),
        ("a", "upon", "start", "a"),
        ("not eventually a", "upon", "start", "not eventually a"),
        ("m", "whenever", "a", "b"),
        ("upon a then eventually b", "upon", "a", "eventually b"),
        ("whenever a then b", "whenever", "a", "b"),
    ],
)
def test_bare_formulas_are_split(checked, text, mode, trigger, consequent):
    spec = checked(f"define m = always (a -> b)\nrequirement R {text}")
    found = spec.requirements["R"]
    parts = (found.mode, format_formula(found.trigger), format_formula(found.consequent))
    assert parts == (Mode(mode), trigger, consequent)


@each(
    ("text", "code"),
    [
        ("whenever a until b then c", "RV040"),
        ("upon once F a then eventually b", "RV040"),
        ("always end", "RV041"),
        ("upon end and a then immediately b", "RV041"),
        ("upon a then eventually end", "RV041"),
        ("whenever end then a", "RV041"),
        ("upon e then (x < 3 and not a)", "RV042"),
        ("a", "RV042"),
        ("(not (a and b))", "RV042"),
        ("upon b and (e or a) then eventually b", "RV043"),
        ('upon e then F a source "x" source "y"', "RV044"),
        ("upon e then F a tags x tags y", "RV044"),
        ("upon e then F a at end: later", "RV045"),
        ("upon end then immediately a scope after (b)", "RV041"),
        ("upon e then F a scope after (F b)", "RV040"),
        # A captured value keeps its type and unit.
        ("upon e then F d > v let v = d", ""),
        ("upon e then F x > v let v = d", "RV022"),
        ("upon e then F state == v let v = state", ""),
        ("upon e then F (v and b) let v = a", ""),
        ("upon e then F a let v = a and b", "RV020"),
        # A share of runs is a percentage between 0 and 100.
        *(
            (f"always a in at least {share} of runs", "RV075")
            for share in ("100 %", "0 %", "95", "95 s", "1e999 %")
        ),
        # No warning if it is intended.
        ("upon e then (immediately (a and b))", ""),
        ("immediately a", ""),
        ("start -> a", ""),
        ("always a", ""),
        ("a until b", ""),
        ("upon end then a", ""),
        ("whenever a then b", ""),
        ("upon e then held(a, 1 s)", ""),
        ("upon e and a or e and b then eventually a", ""),
        ("upon (e or a) and f then eventually a", ""),
        ("upon e then once[0, 1 s] a", ""),
    ],
)
def test_refusals_and_warnings(codes, text, code):
    found = codes(f"requirement R {text}")
    assert found == code.split() or (found == ["RV060"] and "scope after (F b)" in text)


def test_clauses(requirement):
    found = requirement(
        '"A text with \\"quotes\\""\n  upon e then within 1 s d < v\n'
        '  tags safety, "near people"\n  let v = d + 1 cm\n  severity high\n'
        '  rationale "because"\n  source "ISO"\n  at end: strong'
    )
    assert found.text == 'A text with "quotes"'
    assert found.tags == ("safety", "near people")
    assert (found.severity, found.rationale, found.source) == ("high", "because", "ISO")
    assert found.at_end is EndPolicy.STRONG
    assert [capture.name for capture in found.captures] == ["v"]


@pytest.mark.parametrize(
    ("clause", "share"),
    [
        ("in at least 95 % of runs", RunShare(True, 95.0)),
        ("in  at most\n 0.5% of runs at end: weak", RunShare(False, 0.5)),
        ('source "a"', None),
    ],
)
def test_a_share_of_runs_is_kept(requirement, clause, share):
    found = requirement(f"upon e then within 1 s a {clause}")
    assert found.run_share == share
    assert share is None or requirement(f"upon e then F a {share}").run_share == share


def test_let_values_are_captured_at_the_trigger(codes, requirement):
    """The trigger cannot read a captured value; a later `let` may read an earlier one."""
    assert codes("requirement R upon d > v then eventually a let v = d") == ["RV012"]
    found = requirement("upon e then F d > w let v = d let w = v + 1 m")
    assert [str(type(capture.value).__name__) for capture in found.captures] == [
        "SignalValue",
        "Arithmetic",
    ]
    assert "Captured" not in str(found.captures[1])


def test_for_each(requirement, codes):
    found = requirement("upon pick then F pick.id == i for each i in pick.id")
    assert (found.for_each.name, found.for_each.value.event) == ("i", "pick")
    assert codes("requirement R upon pick and i == 3 then F a for each i in pick.id") == []
    assert codes("requirement R upon e then F a for each i in x") == ["RV021"]
    assert codes("requirement R upon e then F a for each i in pick.z") == ["RV012"]
