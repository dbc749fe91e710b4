"""What the law says of a case, worked out once for all engines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

from rvmon.language.checked.specification import Requirement
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.decisions import Followed, Followings
from rvmon.testing.law.syntax import is_upon_end
from rvmon.testing.law.word import Truth
from rvmon.testing.oracle import judge_views, report_on
from rvmon.trace.sample import Health
from rvmon.verdicts.report import Report
from tests.tools.compare import Key, Outcome, outcomes
from tests.tools.health import expected_health, may_be_simplified
from tests.tools.law import word
from tests.tools.moments import Moment
from tests.tools.seen import Seen
from tests.tools.waiting import Waiting


class Judgement:
    """The oracle's view of a case; each part is made when it is first asked for, and kept."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.word = word(case)
        self.followings: Mapping[str, Followings] = judge_views(case.spec, self.word, case.samples)

    @cached_property
    def report(self) -> Report:
        """The oracle's report."""
        samples = self.case.samples
        origin = samples[0].t if samples else 0
        return report_on(self.case.spec, self.followings, origin=origin, end=self.word.end)

    @cached_property
    def outcomes(self) -> Mapping[Key, Outcome]:
        """The outcome of every attempt."""
        return outcomes(self.report)

    @cached_property
    def health(self) -> Sequence[Health]:
        """The findings on the inputs."""
        return expected_health(self.case, self.word)

    @cached_property
    def seen(self) -> Seen:
        """What attempts see of the inputs."""
        starts = {
            key: one.start
            for name, followings in self.followings.items()
            for one in followings.attempts
            for key in ((name, False, one.number), (name, True, one.doubtful_number))
        }
        return Seen(self.case.spec, starts)

    def at(self, moment: Moment) -> tuple[dict[Key, Outcome], dict[Key, Waiting]]:
        """What the prefix has decided at a moment, and what waits; without attempts upon `end`.

        A decision before the instant that time has come to is the same however much is known
        later; one at that very instant may have needed its letter, which is tried.
        """
        decided: dict[Key, Outcome] = {}
        waiting: dict[Key, Waiting] = {}
        for key, requirement, one in self._begun(moment):
            simplified = may_be_simplified(requirement, self.case.spec.time)
            here = Waiting(one.start, moment, simplified=simplified)
            if self._is_decided(one, moment, here):
                if key in self.outcomes:  # what was met in doubt vanishes
                    decided[key] = self.outcomes[key]
            else:
                waiting[key] = here
        return decided, waiting

    def _is_decided(self, one: Followed, moment: Moment, here: Waiting) -> bool:
        if one.decided is None or one.decided[0] > moment.reached:
            return False
        if one.decided[0] < moment.reached or moment.end == moment.reached:
            return True
        return here.truth is not Truth.UNKNOWN

    def _begun(self, moment: Moment) -> Iterator[tuple[Key, Requirement, Followed]]:
        """The attempts whose trigger is known at a moment."""
        for name, followings in self.followings.items():
            requirement = self.case.spec.requirements[name]
            if is_upon_end(requirement):
                continue
            for one in followings.attempts:
                if one.start.triggered <= moment.end:
                    yield (name, *_number_at(one, moment)), requirement, one


def _number_at(one: Followed, moment: Moment) -> tuple[bool, int]:
    """Whether an attempt is in doubt at a moment, and its number then."""
    sure = one.start.sure
    if sure is not None and one.start.word.letters[sure].instant <= moment.end:
        return False, one.number
    return True, one.doubtful_number
