"""Cases of the differential test for compiled monitors."""

import numpy as np

from rvmon.codegen.c_batch import BatchLibrary
from rvmon.codegen.c_columns import columns_of_samples
from rvmon.testing.case import Case
from rvmon.trace.sample import Sample
from rvmon.verdict.assemble import report_of
from rvmon.verdict.report import Report


def judge_by(library: BatchLibrary, case: Case) -> Report:
    """The report of a compiled monitor on a case."""
    rows = [a if isinstance(a, Sample) else Sample(a, {}) for a in case.actions]
    times = np.array([row.t for row in rows], np.int64)
    advances = np.array([not isinstance(a, Sample) for a in case.actions], np.uint8)
    columns = columns_of_samples(rows, library.names)
    declared = {*case.spec.signals, *case.spec.events}
    absent = frozenset() if case.names is None else frozenset(declared - case.names)
    judged = library.judge(times, columns, absent=absent, until=case.end, advances=advances)
    assert judged.rows == len(case.actions)
    return report_of(tuple(case.spec.requirements), judged.attempts, end=judged.end)
