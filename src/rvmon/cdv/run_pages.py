"""Single tests played again, with their samples, and the pages of such runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from rvmon.cdv.abstract_test import Test
from rvmon.cdv.campaign import Robot
from rvmon.cdv.checker import Checker
from rvmon.cdv.outcome import Outcome
from rvmon.cdv.play import outcome_of, run_of, system_of
from rvmon.cdv.system import Observer, Run, Values
from rvmon.report.markup import Child
from rvmon.report.panels import JudgedRun, RunPage
from rvmon.report.run_html import run_page
from rvmon.session import Spec
from rvmon.trace.sample import Sample
from rvmon.verdict.report import Report


@dataclass(frozen=True, slots=True)
class Replay:
    """A test that was played again.

    Attributes:
        test: that was played.
        run: what the system reported of it at its end.
        samples: that it reported before.
        report: the verdicts.
    """

    test: Test
    run: Run
    samples: tuple[Sample, ...]
    report: Report

    @property
    def outcome(self) -> Outcome:
        """What a campaign keeps of the run; what it hit was not measured."""
        return outcome_of(self.run, self.report)

    @property
    def judged(self) -> JudgedRun:
        """The run as its page wants it."""
        return JudgedRun(self.test.name, self.report, self.samples)


def play_again(test: Test, name: str, robot: Robot, spec: Spec) -> Replay:
    """Play one test in this process with its scene recorded: the run that the campaign had.

    Args:
        test: what is played.
        name: of the robot.
        robot: against which.
        spec: what judges it.
    """
    checker = Checker(spec)
    samples: list[Sample] = []

    def note(t_ns: int, values: Values) -> None:
        samples.append(Sample(t_ns, dict(values)))

    observer = Observer((checker.observe, note), wants_scene=True)
    run = run_of(system_of(name, robot), test, observer)
    report = replace(checker.finish(run.end_ns), trace=test.name)
    return Replay(test, run, tuple(samples), report)


def replay_page(
    replay: Replay,
    robot: str,
    spec: Spec,
    *,
    command: str,
    others: Sequence[JudgedRun] = (),
    back: str = "",
    smallest: Child = None,
) -> str:
    """The page of one test.

    Args:
        replay: the test.
        robot: its name.
        spec: that judged it.
        command: replays it.
        others: runs that a failed attempt can be held against.
        back: address of the campaign's page.
        smallest: the smallest test that fails alike, or how to find it.
    """
    facts: list[tuple[str, Child]] = [*_facts(replay, robot, spec)]
    if smallest is not None:
        facts.append(("smallest test that fails alike", smallest))
    return run_page(
        RunPage(
            run=replay.judged,
            spec=spec.checked,
            command=command,
            others=others,
            facts=facts,
            scene=replay.run.scene,
            back=back,
        )
    )


def _facts(replay: Replay, robot: str, spec: Spec) -> list[tuple[str, str]]:
    test = replay.test
    facts = [("test", test.name)]
    if test.text:
        facts.append(("purpose", test.text))
    facts += [("robot", robot), ("specification", spec.checked.name)]
    if test.mutation is not None:
        facts.append(("planted fault", test.mutation))
    facts += [("seed", str(test.seed)), *replay.run.facts]
    if replay.run.error is not None:
        facts.append(("robot crashed", replay.run.error))
    return facts
