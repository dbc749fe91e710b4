"""Say whether a campaign is as expected: why not, and what was known to fail."""

from __future__ import annotations

from argparse import Namespace

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.gate import CampaignJudgement
from rvmon.cdv.junit import junit_xml
from rvmon.cli.say import warn
from rvmon.report.folder import write_file
from rvmon.report.percent import counted

SHOWN = 20
"""Lines about what is wrong; `--junit` has all of them."""


def held(campaign: Campaign, judgement: CampaignJudgement, arguments: Namespace) -> bool:
    """Print, and write as JUnit XML, what a campaign came to; return whether all is as expected.

    Args:
        campaign: what it was about.
        judgement: on its tests.
        arguments: with `junit`, the path of a file or `None`.
    """
    if arguments.junit is not None:
        write_file(arguments.junit, junit_xml(campaign.name, judgement))
    for what, count in judgement.known.items():
        warn(f"{what} ({counted(count, 'test')})")
    wrong = judgement.wrong
    for what in wrong[:SHOWN]:
        warn(f"not as expected: {what}")
    if len(wrong) > SHOWN:
        warn(f"not as expected: … and {len(wrong) - SHOWN:,} more: --junit FILE has all")
    return not wrong
