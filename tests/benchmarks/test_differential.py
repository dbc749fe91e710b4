"""The command that compares ours with something independent."""

import re

import pytest
from benchmarks.comparisons import monitors
from benchmarks.differential import COMPARISONS, main

FEW = {
    "verdicts": (
        6,
        ["traces=4", "online_every=6", "forms=c,c rows,c+next,c+interrupt"],
        "pairs",
        24,
    ),
    "robustness": (2, [], "measured by arrays", 16),
    "coverage": (6, [], "pairs", 60),
    "long": (24, ["samples=1000"], "samples", 18_000),
    "forecasts": (15, ["words=5"], "formulas", 12),
    "fillings": (20, ["fillings=3"], "verdict P", 1),
    "doors": (1, [], "CSV", 4),
    "networks": (2, [], "runs checked as concrete runs", 10),
    "logics": (5, [], "CTL: true", 5),
    "damage": (60, [], "spec: refused", 1),
}
"""How many, settings, and a count with what it is at least."""


def test_each_is_tried() -> None:
    """All but those that ask other monitors, which are not installed here."""
    assert COMPARISONS.keys() - FEW.keys() == {"peers", "peers-robustness"}


def counts(printed: str) -> dict[str, int]:
    found = re.findall(r"^  (\S.*?)  +([\d,]+)$", printed, re.MULTILINE)
    return {name: int(figure.replace(",", "")) for name, figure in found}


@pytest.mark.law
@pytest.mark.parametrize("name", FEW)
def test_a_few_of_each(
    name: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RVMON_CACHE", "on")  # `damage` switches it off in its process, for good
    count, given, what, least = FEW[name]
    assert main([name], count=count, set_=given) == 0
    found = counts(capsys.readouterr().out)
    assert found["disagreements"] == 0
    assert found[what] >= least
    if name == "verdicts":
        assert {found[f"judged by {form}"] for form in given[-1][6:].split(",")} == {24}
    if name == "forecasts":
        assert main([name], count=15, set_=["words=20", "timed=true"]) == 0
        found = counts(capsys.readouterr().out)
        assert found["disagreements"] == 0
        forecasts = [found.get(f"forecast {verdict}", 0) for verdict in "PF"]
        assert sum(forecasts) > 100 * found.get("missed", 0)
    if name == "long":
        assert min(found[f"attempts {verdict}"] for verdict in "PF") > 50
        assert found["judged by an automaton"]
        assert found["judged by a network"]


@pytest.mark.law
def test_what_disagrees_is_shown(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is counted, shrunk and printed; the exit code is 1."""
    monkeypatch.setattr(monitors, "margins", lambda *_: {})
    assert main(["robustness"], count=1) == 1
    printed = capsys.readouterr().out
    assert counts(printed)["disagreements"] > 1
    assert 1 < printed.count("=" * 72) <= 5
    assert "expected None" in printed


@pytest.mark.parametrize(
    ("name", "given", "told"),
    [
        ("verdicts", "forms=abacus", "no form `abacus`: there are c, c rows"),
        ("verdicts", "forms=c rows+next", "no form `c rows\\+next`"),
        ("coverage", "depth=2", "no setting `depth`: there are none"),
        ("long", "depth=2", "no setting `depth`: there are samples"),
        ("fillings", "time=never", "never"),
        ("nothing", "", "no comparison `nothing`: there are verdicts, "),
    ],
)
def test_a_setting_that_does_not_exist(name: str, given: str, told: str) -> None:
    with pytest.raises(SystemExit, match=told):
        main([name], set_=[given])
