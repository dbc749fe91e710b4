"""Cases of the differential test as columns for compiled monitors."""

from collections.abc import Mapping

import numpy as np

from rvmon.codegen.c_batch import NO, UNKNOWN, YES, BatchLibrary, Column
from rvmon.codegen.c_names import Names
from rvmon.testing.case import Case
from rvmon.trace.sample import Sample
from rvmon.verdict.assemble import report_of
from rvmon.verdict.report import Report


def columns_of_case(case: Case, names: Names):
    """Times, which rows are advances, and the columns of a case."""
    n = len(case.actions)
    times = np.array([a.t if isinstance(a, Sample) else a for a in case.actions], np.int64)
    advances = np.array([not isinstance(a, Sample) for a in case.actions], np.uint8)
    columns = {name: Column(np.zeros(n, np.uint8), np.zeros(n)) for name in names.plan.signals}
    columns |= {name: Column(np.zeros(n, np.uint8)) for name in names.plan.events}
    columns |= {f"{e}.{f}": Column(None, np.full(n, np.nan)) for e, f in names.fields}
    for row, action in enumerate(case.actions):
        if isinstance(action, Sample):
            for name, value in action.values.items():
                _set(columns, names, name, row, value)
    return times, advances, columns


def _set(columns, names, name, row, value):
    column = columns[name]
    if name in names.plan.signals:
        unknown = value is None or value != value
        column.states[row] = UNKNOWN if unknown else YES
        if not unknown:
            column.values[row] = names.label(value) if isinstance(value, str) else float(value)
        return
    if isinstance(value, tuple):
        assert len(value) <= 1
        value = value[0] if value else False
    column.states[row] = UNKNOWN if value is None else NO if value is False else YES
    if isinstance(value, Mapping):
        for field, scalar in value.items():
            if scalar is not None:
                number = names.label(scalar) if isinstance(scalar, str) else float(scalar)
                columns[f"{name}.{field}"].values[row] = number


def judge_by(library: BatchLibrary, case: Case) -> Report:
    """The report of a compiled monitor on a case."""
    times, advances, columns = columns_of_case(case, library.names)
    declared = {*case.spec.signals, *case.spec.events}
    absent = frozenset() if case.names is None else frozenset(declared - case.names)
    judged = library.judge(times, columns, absent=absent, until=case.end, advances=advances)
    assert judged.rows == len(case.actions)
    return report_of(tuple(case.spec.requirements), judged.attempts, end=judged.end)
