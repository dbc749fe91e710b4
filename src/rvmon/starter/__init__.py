"""A first specification from a recording, and a first campaign of tests; both run at once."""

from __future__ import annotations

from importlib import resources

_ENDING = ".txt"


def campaign_files() -> dict[str, str]:
    """The texts of its files, by name: code under test, requirements, and the campaign.

    >>> sorted(campaign_files())
    ['campaign.py', 'lift.py', 'lift.rv']
    """
    folder = resources.files("rvmon.starter") / "campaign"
    files = sorted(folder.iterdir(), key=lambda one: one.name)
    return {
        one.name.removesuffix(_ENDING): one.read_text(encoding="utf-8")
        for one in files
        if one.name.endswith(_ENDING)
    }
