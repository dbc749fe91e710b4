"""What a page opens on."""

import pytest

import rvmon
from rvmon.report.panels import opening


def test_a_specification_without_requirements_has_no_page():
    """There is nothing to open on: the message says what to add."""
    report = rvmon.loads('spec a "A"\nsignal p : bool\n').evaluate([(0.0, {"p": True})])
    with pytest.raises(rvmon.RvmonError, match="the specification has none: add one"):
        opening(report)
