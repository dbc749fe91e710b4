"""The command of the differential test: which forms, which figures."""

from __future__ import annotations

import pytest
from benchmarks.differential import main, parse


@pytest.mark.slow
def test_several_forms_share_the_cases(capsys: pytest.CaptureFixture[str]) -> None:
    """Each form, and each way of driving it, has its own count of disagreements."""
    forms = ["--form", "c", "c rows", "--interrupt", "--next"]
    assert main([*forms, "--pairs", "24", "--traces", "4", "--online-every", "6"]) == 0
    lines = capsys.readouterr().out.splitlines()
    figures = [line for line in lines if " judged " in line]
    assert [one.split(" judged ")[0].strip() for one in figures] == [
        *("c", "c rows", "c+next", "c+interrupt"),
    ]
    assert all("judged 24, refused 0, disagreements 0" in one for one in figures)


@pytest.mark.parametrize("name", ["abacus", "c rows+next", "c+later", "+next"])
def test_a_form_that_does_not_exist(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """It is named, with those that there are."""
    with pytest.raises(SystemExit):
        parse(["--form", name])
    assert f"no form `{name}`: there are c, " in capsys.readouterr().err
