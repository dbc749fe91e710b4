"""Pages of single runs, played again with the scene recorded."""

from __future__ import annotations

from collections.abc import Sequence

from handover.campaign.scene import scene_of
from handover.driver.run import Run
from rvmon.report.run_html import run_page
from rvmon.report.run_page import JudgedRun, RunPage
from rvmon.session import Spec
from rvmon.trace.sample import Sample
from rvmon.verdict.report import Report

OUTCOMES = {
    "timed_out": "the robot timed out",
    "released": "the piece was released",
    "withheld": "the robot kept the piece",
}
"""What ends a handover, by the event that tells it."""


def judged(run: Run, report: Report) -> JudgedRun:
    """A simulated run as its page wants it."""
    samples = tuple(Sample(t_ns, values) for t_ns, values in run.samples)
    return JudgedRun(run.test.name, report, samples)


def simulated_page(
    run: Run,
    report: Report,
    spec: Spec,
    *,
    command: str,
    others: Sequence[JudgedRun] = (),
    back: str = "",
) -> str:
    """The page of one simulated test.

    Args:
        run: with its scene recorded.
        report: the verdicts on it.
        spec: that judged it.
        command: replays it.
        others: runs that a failed attempt can be held against.
        back: address of the campaign's page.
    """
    return run_page(
        RunPage(
            run=judged(run, report),
            spec=spec.checked,
            command=command,
            others=others,
            facts=_facts(run, spec),
            scene=None if run.poses is None else scene_of(run.poses),
            back=back,
        )
    )


def _facts(run: Run, spec: Spec) -> list[tuple[str, str]]:
    happened = {name for _, values in run.samples for name in values}
    outcome = next((text for event, text in OUTCOMES.items() if event in happened), "none")
    facts = [("test", run.test.name)]
    if run.test.text:
        facts.append(("purpose", run.test.text))
    facts += [("robot", run.robot), ("judged by", spec.checked.name)]
    if run.mutation is not None:
        facts.append(("planted fault", run.mutation))
    facts += [("seed", str(run.test.seed)), ("outcome", outcome)]
    if run.error is not None:
        facts.append(("robot crashed", run.error))
    return facts
