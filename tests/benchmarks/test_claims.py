"""The page of claims: it can be read, and a claim that does not hold is noticed."""

import pytest
from benchmarks.claims import PAGE, Claim, ClaimError, claims_of

ROW = "## In three minutes\n| it is so | `true` | {} | `5` | {} |\n"


def test_the_page_can_be_read():
    """Each row has a command, a pattern with one group, a value and a tolerance."""
    page = PAGE.read_text(encoding="utf-8")
    quick, every = claims_of(page, long=False), claims_of(page, long=True)
    assert quick
    assert every[: len(quick)] == quick != every


@pytest.mark.parametrize(
    ("tolerance", "fits", "fails"),
    [
        ("exact", "5", "5.0"),
        ("at least", "1,000", "4"),
        ("at most", "5", "6"),
    ],
)
def test_a_tolerance_is_kept(tolerance, fits, fails):
    claim = Claim("", "", "", "5", tolerance)
    assert claim.holds_for(fits)
    assert not claim.holds_for(fails)


@pytest.mark.parametrize(
    ("pattern", "tolerance"),
    [("`a`", "exact"), ("`(`", "exact"), ("`(a)`", "roughly"), ("`(a)` |", "exact")],
)
def test_a_malformed_row_is_refused(pattern, tolerance):
    """With its line: a claim that nothing checks would look as if it held."""
    with pytest.raises(ClaimError, match="line 2"):
        claims_of(ROW.format(pattern, tolerance), long=False)
