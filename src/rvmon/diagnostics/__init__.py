"""What is wrong with a text that a person wrote: as data here, as text in the renderers."""

from rvmon.diagnostics.diagnostic import Diagnostic, Label, Severity
from rvmon.diagnostics.span import Source, Span

__all__ = ["Diagnostic", "Label", "Severity", "Source", "Span"]
