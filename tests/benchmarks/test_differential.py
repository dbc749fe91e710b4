"""The command of the differential test: which engines, which figures."""

from __future__ import annotations

import pytest
from benchmarks.differential import main, parse
from benchmarks.engines import PACKAGE
from benchmarks.mutants import Stage, stages_of

from benchmarks import mutants


@pytest.mark.slow
def test_several_engines_share_the_cases(capsys: pytest.CaptureFixture[str]) -> None:
    """Each engine, and each way of driving it, has its own count of refusals and disagreements."""
    engines = ["--engine", "automaton", "network", "progression", "--interrupt", "--next"]
    assert main([*engines, "--pairs", "24", "--traces", "4", "--online-every", "6"]) == 0
    lines = capsys.readouterr().out.splitlines()
    figures = [line.split() for line in lines if " judged " in line]
    plain = ["automaton", "network", "progression"]
    ways = [f"{name}{way}" for way in ("+next", "+interrupt") for name in plain]
    assert [words[0] for words in figures] == [*plain, *ways]
    counts = {words[0]: (int(words[2][:-1]), int(words[4][:-1])) for words in figures}
    assert all(sum(count) == 24 for count in counts.values())
    assert counts["network"] == counts["network+next"] == (24, 0)
    assert all(words[-1] == "0" for words in figures)


@pytest.mark.parametrize("name", ["abacus", "c+next", "network+later", "+next"])
def test_an_engine_that_does_not_exist(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """It is named, with those that there are."""
    with pytest.raises(SystemExit):
        parse(["--engine", name])
    assert f"no form `{name}`: there are auto, " in capsys.readouterr().err


def test_stages_of_a_mutant() -> None:
    """Few pairs first, tests last; only what a monitor can be asked for is driven in other ways."""
    *stages, tests = stages_of("network", [PACKAGE / "dataflow" / "network.py"], 100)
    ways = [stage.engines for stage in stages if isinstance(stage, Stage)]
    both = ("network+next", "network+interrupt")
    assert ways == [("network",), ("network",), both, ("network",), ("auto",)]
    assert isinstance(tests, mutants.Tests)
    assert "tests/rvmon/dataflow" in tests.folders
    stages = stages_of("c", [], 100)[:-1]
    ways = [stage.engines for stage in stages if isinstance(stage, Stage)]
    assert ways == [("c",), ("c",), ("c",), ("c rows",)]
