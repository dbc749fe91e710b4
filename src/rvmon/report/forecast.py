"""A forecast in words."""

from __future__ import annotations

from rvmon.verdict.verdict import Verdict


def forecast_sentence(forecast: Verdict) -> str:
    """What an undecided attempt comes to, however the run goes on.

    >>> forecast_sentence(Verdict.FAIL)
    'forecast F: no continuation can fulfil it'
    """
    if forecast is Verdict.PASS:
        return "forecast P: every continuation fulfils it"
    return "forecast F: no continuation can fulfil it"
