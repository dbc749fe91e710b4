"""Play a suite on mutants, each in its own process.

A mutant is planted into a running process. Loaded functions get the changed code object, so that
all references to them see the change. A changed constant is evaluated again, together with the
constants of its file that depend on it. A file that is not loaded yet is loaded with the change.
Nothing is undone, so the process must end afterwards.
"""

from __future__ import annotations

import ast
import gc
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from functools import partial
from importlib.machinery import SourceFileLoader
from types import CodeType, FrameType, FunctionType, ModuleType

from rvmon.cdv.mutation.baseline import Suite, difference, recorder
from rvmon.cdv.mutation.python_mutants import Mutant
from rvmon.cdv.mutation.survivors import Finding, How, Tried
from rvmon.cdv.play import Bench, Progress, Recorded
from rvmon.errors import RvmonError
from rvmon.execute import Ended, parallel
from rvmon.texts import text_of_file
from rvmon.verdicts import Verdict


def plant(mutant: Mutant, source: str) -> None:
    """Apply a mutant to the code of this process; `source` is the unchanged text of its file.

    Raises:
        RvmonError: the mutant cannot be planted; the message says why.
    """
    path = os.path.abspath(mutant.path)
    changed = compile(mutant.source, path, "exec")
    _change_loader(path, changed)
    modules = [module for module in list(sys.modules.values()) if _path_of(module) == path]
    if not modules:
        return
    known = _codes_of(compile(source, path, "exec"), mutant.function)
    if known:
        _change_functions(path, modules, known, _codes_of(changed, mutant.function))
    else:
        for module in modules:
            _change_constants(module, mutant)


def _path_of(module: ModuleType) -> str | None:
    path = getattr(module, "__file__", None)
    return os.path.abspath(path) if path else None


def _change_loader(path: str, changed: CodeType) -> None:
    """Load the file with the change, if it is loaded later."""
    known = SourceFileLoader.get_code

    def get_code(self: SourceFileLoader, name: str) -> CodeType | None:
        return changed if os.path.abspath(self.path) == path else known(self, name)

    SourceFileLoader.get_code = get_code  # type: ignore[method-assign,assignment]  # on purpose


def _codes_of(code: CodeType, name: str) -> list[CodeType]:
    """The functions with a qualified name, in file order; the methods of a property share one."""
    return [code_type for code_type in _all_codes(code) if code_type.co_qualname == name]


def _all_codes(code: CodeType) -> Iterator[CodeType]:
    for const in code.co_consts:
        if isinstance(const, CodeType):
            yield const
            yield from _all_codes(const)


def _change_functions(
    path: str, modules: list[ModuleType], known: list[CodeType], changed: list[CodeType]
) -> None:
    by_line = {old.co_firstlineno: new for old, new in zip(known, changed, strict=True)}
    gc.unfreeze()  # so that functions from the parent process are found, too
    # A function refers to its globals, the module's namespace. Searching only its referrers leaves
    # the reference counts of other objects alone, so their memory is not copied after a fork.
    found = gc.get_referrers(*map(vars, modules))
    gc.freeze()
    for function in found:
        if not isinstance(function, FunctionType):
            continue
        code = function.__code__
        if code.co_qualname == known[0].co_qualname and os.path.abspath(code.co_filename) == path:
            try:
                function.__code__ = by_line[code.co_firstlineno]
            except (KeyError, ValueError) as error:
                raise RvmonError(f"`{code.co_qualname}` cannot be changed: {error}") from None


def _change_constants(module: ModuleType, mutant: Mutant) -> None:
    """Evaluate and rebind a changed constant, and the constants of its file that depend on it."""
    namespace = dict(vars(module))
    names = {mutant.function}
    for statement in ast.parse(mutant.source).body:
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
                read = {node.id for node in ast.walk(statement) if isinstance(node, ast.Name)}
                if name in names or names & read:
                    only = ast.Module([statement], [])
                    exec(compile(only, str(mutant.path), "exec"), namespace)  # noqa: S102 - our mutant
                    names.add(name)
    for name in names:
        old = getattr(module, name, None)
        for other in list(sys.modules.values()):
            # Other modules may have imported the constant by name.
            if getattr(other, "__dict__", {}).get(name) is old:
                setattr(other, name, namespace[name])


MOST_MEMORY = 2 << 30
"""Bytes that a mutant may allocate in addition to what its process starts with."""

LEAST_CPU_S = 0.5
TIMES_CPU = 10
"""A test hangs if it takes more processor time than `LEAST_CPU_S` plus `TIMES_CPU` times the time
it takes on the unchanged code."""

HANGS = "it does not end: its time, or its memory, is used up"
"""The text for both limits: an endless loop that also allocates may reach either one first."""

PATIENCE_S = 60.0
"""Wall time that a mutant may take in addition to that of the suite."""


def play_mutants(
    suite: Suite,
    mutants: Sequence[Mutant],
    *,
    jobs: int,
    every: bool = False,
    keep: bool = False,
    progress: Progress | None = None,
) -> list[Tried]:
    """Play, on each mutant, the tests that run its changed line.

    A mutant that hangs, crashes or takes too much memory does not affect others, as it has its own
    process with limits. It can still write files.

    Args:
        suite: the tests, recorded on the unchanged code.
        mutants: the mutants to play.
        jobs: number of processes.
        every: play all these tests, instead of stopping once a requirement fails.
        keep: keep the first run in which a requirement fails.
        progress: called after each mutant.

    Returns:
        The result of each mutant, in the given order; it does not depend on `jobs`.
    """
    _load_what_runs_need(suite)
    sources = {str(mutant.path): text_of_file(mutant.path) for mutant in mutants}
    tasks = [(mutant, suite.reaching(mutant)) for mutant in mutants]
    tried: list[Tried] = []
    with closing(
        parallel.execute(
            (task for task in tasks if task[1]),
            partial(_start_worker, suite, sources, every, keep),
            jobs=jobs,
            what="mutant",
            instead=_outcome_of_ended,
            timeout_s=_wall_limit_s(suite),
            fresh=True,
        )
    ) as results:
        for number, (mutant, reaching) in enumerate(tasks, start=1):
            tried.append(next(results) if reaching else Tried(mutant, 0))
            if progress is not None:
                progress(number)
    return tried


_Task = tuple[Mutant, Sequence[str]]


def _load_what_runs_need(suite: Suite) -> None:
    """Play the fastest test here, so that worker processes need not load the same modules again."""
    quickest = min(suite.recorded, key=lambda name: suite.recorded[name].cpu_s)
    Bench(suite.name, suite.robot).play(suite.tests[quickest])


def _start_worker(
    suite: Suite, sources: dict[str, str], every: bool, keep: bool
) -> Callable[[_Task], Tried]:
    _limit_process()
    return partial(_try_mutant, suite, sources, every, keep)


def _try_mutant(
    suite: Suite, sources: dict[str, str], every: bool, keep: bool, task: _Task
) -> Tried:
    mutant, reaching = task
    try:
        plant(mutant, sources[str(mutant.path)])
    except RvmonError as error:
        return Tried(mutant, len(reaching), invalid=str(error))
    findings: list[Finding] = []
    first = failing = None
    played = 0
    play = recorder(suite.name, suite.robot)
    for name in reaching:
        played += 1
        was = suite.recorded[name]
        try:
            with _cpu_limit(_cpu_limit_s(was)):
                now = play(suite.tests[name])
        except _Overtime:
            findings.append(Finding(name, How.HUNG, (HANGS,)))
            continue
        finding = _finding(suite, name, was, now)
        if finding is not None:
            findings.append(finding)
            if finding.how is How.REQUIREMENT:
                failing = failing or ((name, now) if keep else None)
                if not every:
                    break
        elif first is None:
            first = difference(name, was, now)
    return Tried(mutant, len(reaching), played, tuple(findings), first, failing=failing)


def _finding(suite: Suite, name: str, was: Recorded, now: Recorded) -> Finding | None:
    failed = tuple(
        requirement
        for requirement, verdict in now.verdicts.items()
        if verdict is Verdict.FAIL and was.verdicts[requirement] is not Verdict.FAIL
    )
    if failed:
        return Finding(name, How.REQUIREMENT, failed)
    if now.run.error is not None:
        if now.run.error.startswith(MemoryError.__name__):
            return Finding(name, How.HUNG, (HANGS,))
        return Finding(name, How.CRASHED, (now.run.error,))
    wrong = tuple(
        requirement
        for requirement, expected in suite.tests[name].expected.items()
        if was.verdicts[requirement].value == expected != now.verdicts[requirement].value
    )
    return Finding(name, How.ANSWER, wrong) if wrong else None


def _cpu_limit_s(was: Recorded) -> float:
    return LEAST_CPU_S + TIMES_CPU * was.cpu_s


def _wall_limit_s(suite: Suite) -> float:
    """The wall time after which a mutant is killed.

    Hanging tests are detected by their processor time; this limit is for those that wait for ever.
    It allows for the ratio of wall time to processor time of the unchanged code, which may have
    waited as well, for its own reasons or for a busy machine.
    """
    recorded = suite.recorded.values()
    computed = max(sum(one.cpu_s for one in recorded), LEAST_CPU_S)
    waited = sum(one.seconds for one in recorded) / computed
    return PATIENCE_S + max(waited, 1.0) * sum(map(_cpu_limit_s, recorded))


def _outcome_of_ended(task: _Task, ended: Ended) -> Tried:
    how = How.HUNG if ended.timed_out else How.LOST
    mutant, reaching = task
    return Tried(mutant, len(reaching), 0, (Finding("", how, (ended.why,)),))


class _Overtime(BaseException):
    """A test took too long; a `BaseException`, so that the code under test does not catch it."""


@contextmanager
def _cpu_limit(cpu_s: float) -> Iterator[None]:
    """Raise `_Overtime` after some processor time, which does not depend on the machine's load."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def interrupt(_: int, __: FrameType | None) -> None:
        raise _Overtime

    signal.signal(signal.SIGPROF, interrupt)
    signal.setitimer(signal.ITIMER_PROF, cpu_s)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def _limit_process() -> None:
    """Limit the memory of this process, and discard its output."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.__stdout__, sys.__stderr__):
        if stream is not None:
            os.dup2(nowhere, stream.fileno())
    if sys.platform == "linux":
        import resource

        with open("/proc/self/statm", encoding="ascii") as file:
            pages = int(file.read().split()[0])
        most = pages * resource.getpagesize() + MOST_MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
