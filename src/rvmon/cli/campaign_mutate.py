"""The command `mutate` of a campaign: measures which small faults its tests detect."""

from __future__ import annotations

import os
import sys
import time
from argparse import Namespace
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.campaign_plan import plan
from rvmon.cdv.mutation.baseline import mutated_code, record_suite
from rvmon.cdv.mutation.play import play_mutants
from rvmon.cdv.mutation.python_mutants import Mutant, code_mutants
from rvmon.cdv.mutation.report import (
    MutationReport,
    SuiteTried,
    mutation_page,
    print_mutants,
    print_mutation,
)
from rvmon.cdv.mutation.spec_mutants import SpecMutant, spec_mutants, try_spec_mutants
from rvmon.cdv.mutation.survivors import equivalents, failing_runs, readers
from rvmon.cdv.tables import to_json
from rvmon.cdv.test import Test, load
from rvmon.cli.output import bar, say, say_json, warn
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.files import output_folder, write_whole
from rvmon.report.printer import Printer, text_of

MOST_LISTED = 10  # the most survivors of a kind printed to a terminal; files list all


def mutate(campaign: Campaign, robot: str, strategies: Sequence[str], arguments: Namespace) -> int:
    """Play suites on mutants of a robot's code and requirements; print and write the scores.

    Returns:
        The exit code: 1 if a mutant declared equivalent made a difference, or, with `--strict`, if
        a mutant survives.
    """
    mutants = _mutants(campaign, robot, arguments)
    if arguments.list:
        every: list[Mutant | SpecMutant] = [*mutants.code, *mutants.spec]
        print_mutants(every, Printer(), held_out=arguments.held_out)
        return 0
    folder = output_folder(arguments.out) if arguments.out else None
    try:
        report = _reported(campaign, robot, strategies, mutants, arguments)
    except BaseException:  # also if interrupted
        if folder is not None:
            with suppress(OSError):  # it contains other files
                folder.rmdir()
        raise
    if arguments.format == "json":
        say_json(to_json(report.document()).decode().removesuffix("\n"))
    else:
        is_short = folder is not None or sys.stdout.isatty()
        print_mutation(report, Printer(), most=MOST_LISTED if is_short else None)
        say(f"{len(mutants.code) + len(mutants.spec)} mutants in {report.seconds:.1f} s.")
    if folder is not None:
        text = text_of(lambda printer: print_mutation(report, printer))
        write_whole(folder / "mutation.txt", text)
        write_whole(folder / "mutation.json", to_json(report.document()))
        write_whole(folder / "mutation.html", mutation_page(report))
    wrong = report.contradictions()
    for what in wrong:
        warn(what)
    return int(bool(wrong) or (arguments.strict and report.survives))


class _Mutants(NamedTuple):
    code: list[Mutant]
    spec: list[SpecMutant]
    equivalent: dict[str, str]


def _mutants(campaign: Campaign, robot: str, arguments: Namespace) -> _Mutants:
    code: list[Mutant] = []
    spec: list[SpecMutant] = []
    equivalent: dict[str, str] = {}
    if arguments.of != "spec":
        mutated = mutated_code(campaign)
        code = code_mutants(mutated)
        if mutated.equivalent is not None:
            equivalent = equivalents(mutated.equivalent, code)
        code = [mutant for mutant in code if arguments.only in mutant.identity]
    if arguments.of != "code":
        spec = spec_mutants(campaign.requirements_of(robot).checked)
        spec = [mutant for mutant in spec if arguments.only in mutant.identity]
    if not code and not spec:
        raise UnknownNameError(f"no mutant has `{arguments.only}` in its name: --list lists all")
    return _Mutants(code, spec, equivalent)


def _reported(
    campaign: Campaign,
    robot: str,
    strategies: Sequence[str],
    mutants: _Mutants,
    arguments: Namespace,
) -> MutationReport:
    jobs = arguments.jobs or os.cpu_count() or 1
    started = time.perf_counter()
    spec = campaign.requirements_of(robot)
    suites = {}
    for name, tests in _suites(campaign, strategies, arguments).items():
        with bar(f"{name}: tests", len(tests)) as show:
            suite = record_suite(campaign, robot, tests, jobs=jobs, progress=show)
        with bar(f"{name}: mutants", len(mutants.code)) as show:
            tried = play_mutants(
                suite,
                mutants.code,
                jobs=jobs,
                every=arguments.all,
                keep=bool(mutants.spec),
                progress=show,
            )
        spec_tried = try_spec_mutants(spec, mutants.spec, {**suite.recorded, **failing_runs(tried)})
        suites[name] = SuiteTried(len(suite.tests), suite.left_out, tuple(tried), tuple(spec_tried))
    return MutationReport(
        campaign.name,
        campaign.robots[robot].title or robot,
        suites,
        mutants.equivalent,
        readers(spec.checked),
        shows_held_out=arguments.held_out,
        seconds=time.perf_counter() - started,
    )


def _suites(
    campaign: Campaign, strategies: Sequence[str], arguments: Namespace
) -> dict[str, Sequence[Test]]:
    tests = arguments.tests
    if isinstance(tests, Path):
        if arguments.strategy is not None:
            raise RvmonError(f"--tests {tests} is a suite by itself: omit --strategy")
        paths = sorted(tests.glob("*.json"))
        if not paths:
            raise RvmonError(f"no test in {tests}: name a folder of .json files")
        return {tests.name: [load(path, campaign.test) for path in paths]}
    return dict(plan(campaign, strategies, tests=tests, seed=arguments.seed).tests)
