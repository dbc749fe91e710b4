"""A first specification from a recording, and a first campaign of tests; both run at once."""

from __future__ import annotations

from importlib import resources

_ENDING = ".txt"


def campaign_files() -> dict[str, str]:
    """The texts of its files, by name: code under test, requirements, and the campaign.

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
