"""The campaign of simulated handovers: its robots, strategies, tables and pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import handover
from handover.campaign.closing import closing
from handover.campaign.flow_chart import flow_chart
from handover.campaign.gates import expected_failures, gates
from handover.campaign.model_page import model_sections
from handover.campaign.system import Handover, without_loss
from handover.campaign.table1 import paper_table, robot_tables, table_document
from handover.checker import SPECS, situations_path, spec_path
from handover.collector.code import TRANSITIONS, robot_code
from handover.generator.abstract_test import AbstractTest, directed
from handover.generator.disturbed import disturbed
from handover.generator.model_based import model_based, save_templates
from handover.generator.pseudorandom import constrained, pseudorandom
from handover.robot.handover import STATES
from rvmon.cdv import Campaign, Control, Robot, Strategy
from rvmon.cdv.campaign_summary import CampaignSummary
from rvmon.cdv.campaign_text import TEMPLATES
from rvmon.cdv.tables import Presentation
from rvmon.errors import not_installed

FOREMOST = ("R1", "R2", "R3", "R4", "R5")
"""The paper's requirements; both robots are judged by them."""

STRATEGIES: Mapping[str, Strategy] = {
    "pseudorandom": pseudorandom,
    "constrained": constrained,
    "model-based": model_based,
    "model-based-shortest": partial(model_based, policy="shortest"),
    "model-based-fastest": partial(model_based, policy="fastest"),
    "disturbed": disturbed,
    "directed": lambda _count, _seed: directed(),  # all test files, regardless of count and seed
}
"""The strategies, in the order of the columns of a table."""

ROBOTS = {"correct": "Correct robot", "legacy": "Robot of the paper's testbench"}
"""The titles of the two robots."""


def handover_campaign(
    robots: Sequence[str] = tuple(ROBOTS), *, monitors: bool = True, conforming: int = 0
) -> Campaign:
    """A campaign against one or both robots.

    Args:
        robots: `correct`, `legacy` or both, in the order of the tables.
        monitors: `False` judges nothing, to measure the cost of judging.
        conforming: the number of runs of each strategy that are compared with the model for the
            page, which takes a second each; 0: the page has no section on the model.

    Raises:
        RvmonError: pymunk is not installed.
    """
    if find_spec("pymunk") is None:
        raise not_installed("the simulation", "pymunk")
    return Campaign(
        name="handover",
        test=AbstractTest,
        strategies=STRATEGIES,
        robots={
            robot: Robot(
                partial(Handover, robot),
                spec_path(robot) if monitors else None,
                coverage=(situations_path(),) if monitors else (),
                title=ROBOTS[robot],
                spec_name=SPECS[robot],
            )
            for robot in robots
        },
        code=robot_code(),
        states=STATES,
        transitions=TRANSITIONS,
        expected_failures=expected_failures(robots) if monitors else (),
        gates=gates(robots) if monitors else {},
        control=Control("without start-up loss", without_loss),
        sources=(Path(handover.__file__).parent,),
        packages=("pymunk",),
        program="handover",
        presentation=Presentation(
            title="Simulated handovers",
            tests="simulated handovers",
            tables=robot_tables,
            further={"paper": paper_table()},
            document=table_document,
            work=_work,
            chart=flow_chart,
            chart_legend="Filled by the share of the state's statements that ran; the number "
            "beside a line is how many tests took it, a dashed line was taken by none.",
            sections=partial(model_sections, count=conforming),
            foremost=FOREMOST if monitors else (),
            write_more=lambda folder, strategies: save_templates(strategies, folder / TEMPLATES),
        ),
        closing=closing(),
    )


def _work(summary: CampaignSummary) -> str:
    stepped_s = summary.figures.get("stepped_s", 0)
    return (
        f"{summary.simulated_s:,.0f} s simulated, {stepped_s:,.0f} s of them with physics, the "
        "rest at rest and jumped over"
    )
