"""Starters: a first specification made from a recording, and a first test campaign.

Both run without changes.
"""

from __future__ import annotations

from importlib import resources

_ENDING = ".txt"


def campaign_files() -> dict[str, str]:
    """The files of the test campaign, text by name: code under test, requirements, campaign.

    >>> sorted(campaign_files())
    ['campaign.py', 'lift.py', 'lift.rv']
    """
    folder = resources.files("rvmon.recordings.starter") / "campaign"
    files = sorted(folder.iterdir(), key=lambda traversable: traversable.name)
    return {
        file.name.removesuffix(_ENDING): file.read_text(encoding="utf-8")
        for file in files
        if file.name.endswith(_ENDING)
    }
