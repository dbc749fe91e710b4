"""The findings of a specification, or of a model, that is refused."""

from collections.abc import Callable, Sequence
from typing import Any

import pytest

from rvmon.diagnostics import Diagnostic
from rvmon.errors import ModelError, SpecError


def findings_of(call: Callable[..., Any], *given: Any, **named: Any) -> Sequence[Diagnostic]:
    """What was found wrong, where a call is to be refused."""
    with pytest.raises((SpecError, ModelError)) as caught:
        call(*given, **named)
    return caught.value.diagnostics


def codes_of(call: Callable[..., Any], *given: Any, **named: Any) -> list[str]:
    """The codes of these findings."""
    return [finding.code for finding in findings_of(call, *given, **named)]
