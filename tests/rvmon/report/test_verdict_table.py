"""Tables of verdicts in all formats."""

import io

import pytest
from msgspec.structs import replace
from tests.tools.each import each

from rvmon.report.html import table_html
from rvmon.report.printer import Printer
from rvmon.report.verdict_table import (
    RunGroup,
    VerdictTable,
    escape,
    print_table,
    table_latex,
    tables_csv,
)
from rvmon.report.wording import MARKS
from rvmon.verdicts import Verdict


def counts(*figures):
    return dict(zip(Verdict, figures, strict=True))


def table(*names, **more):
    """Two requirements under groups of 100 runs."""
    rows = {"R1": counts(33, 0, 67, 0), "R2": counts(0, 1, 90, 9)}
    return VerdictTable(
        title="Robot_1 & co",
        requirements={"R1": "It shall move", "R2": "It shall stop"},
        groups=tuple(RunGroup(name, 100, rows) for name in names),
        **more,
    )


OURS = table("random", "directed", checked={"R1": True, "R2": None}, notes=("50 % is fitted.",))
PAPER = VerdictTable(
    "Paper", {"R1": "", "R2": ""}, (RunGroup("random", 100, {"R1": counts(30, 0, 70, 0)}),)
)


def as_text(shown, **further):
    """The table on a terminal without colours."""
    text = io.StringIO()
    print_table(shown, Printer(text, 80, has_colour=False), **further)
    return text.getvalue()


def test_tables_equal_their_reference(golden):
    """Published counts are in a second line; counts on the page link to examples."""
    golden("table.txt", as_text(OURS, further={"paper": PAPER}))
    golden("table.tex", table_latex(OURS))
    golden("table.csv", tables_csv({"ours": OURS, "paper": PAPER}))
    link = "#{}-{}-{}".format
    golden("table.html", table_html(OURS, further={"paper": PAPER}, link=link) + "\n")


def test_intervals_equal_their_reference(golden):
    """Each count has the interval of its share below, rounded outwards."""
    sampled = replace(OURS, shows_intervals=True)
    golden("intervals.txt", as_text(sampled, further={"paper": PAPER}))
    golden("intervals.tex", table_latex(sampled))
    golden("intervals.csv", tables_csv({"ours": sampled, "paper": PAPER}))
    page = table_html(sampled, further={"paper": PAPER})
    assert page.count("<small>23–44</small>") == 2
    assert "<small>0–4</small>" in page


@pytest.mark.parametrize("groups", [1, 2, 3, 4, 5])
def test_text_fits_into_80_columns(groups):
    names = ["pseudorandom", "constrained", "model-based", "directed", "more"][:groups]
    shown = as_text(table(*names, checked={"R1": True, "R2": None}))
    assert "…" not in shown
    assert max(len(line.rstrip()) for line in shown.splitlines()) <= 80
    assert shown.count(" 33 ") == groups
    assert all(name in shown for name in names)


def test_wide_counts_stay_apart():
    rows = {"R1": counts(1680, 123308, 0, 7)}
    wide = VerdictTable("wide", {"R1": ""}, tuple(RunGroup(n, 124995, rows) for n in "abc"))
    for line in as_text(wide).splitlines():
        assert not line.startswith("R1") or line.split() == ["R1", "1680", "123308", "·", "7"]


def test_latex_escapes_every_special_character():
    assert escape(r"a_b & 5 % \x {y} ~^ #1 $") == (
        r"a\_b \& 5 \% \textbackslash{}x \{y\} \textasciitilde{}\textasciicircum{} \#1 \$"
    )


@each("verdict", Verdict)
@each(("shade", "page"), [("light", "#fbfbfa"), ("dark", "#0f1215")])
def test_colours_can_be_read(verdict, shade, page):
    """The contrast of each verdict's colour with the page is at least 4.5 to 1 (WCAG AA)."""
    bright, dark = sorted((luminance(getattr(MARKS[verdict], shade)), luminance(page)))[::-1]
    assert (bright + 0.05) / (dark + 0.05) >= 4.5


def test_signs_tell_verdicts_apart_without_colour():
    assert len({mark.sign for mark in MARKS.values()}) == len(Verdict)


def luminance(colour):
    """Relative luminance of an sRGB colour (WCAG 2)."""
    channels = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return sum(weight * c for weight, c in zip((0.2126, 0.7152, 0.0722), linear, strict=True))
