"""The figures of `table.json` beside those of any campaign: the model's and the paper's."""

from __future__ import annotations

from handover.campaign.paper import SOURCE, paper_table
from handover.campaign.tables import checked_of
from rvmon.cdv import documents
from rvmon.cdv.summary import CampaignSummary


def table_document(summary: CampaignSummary) -> dict[str, object]:
    """The content of `table.json`; all of it but `seconds` follows from the seed."""
    checked = checked_of(summary)
    more: dict[str, object] = {"model_checking": checked} if checked else {}
    table = paper_table()
    more["paper"] = {
        "source": SOURCE,
        "model_checking": table.checked,
        "strategies": {
            group.name: {
                "tests": group.runs,
                "requirements": documents.rows_document(group.counts),
            }
            for group in table.groups
        },
    }
    return documents.table_document(summary, control_key="without_startup_loss", more=more)
