"""A document compiled as far as it goes, and what editors ask about it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import resources
from pathlib import Path

from lsprotocol.types import (
    CodeDescription,
    Diagnostic,
    DiagnosticRelatedInformation,
    DiagnosticSeverity,
    DiagnosticTag,
    DocumentSymbol,
    Location,
    SymbolKind,
)
from pygls.uris import from_fs_path, to_fs_path

from rvmon.diagnostics import diagnostic as findings
from rvmon.diagnostics.nearest import proposed
from rvmon.diagnostics.shown import shown
from rvmon.diagnostics.span import Source, Span
from rvmon.lsp.code_pages import page_uri
from rvmon.lsp.names import Names
from rvmon.lsp.text import Text
from rvmon.spec.compile import Compilation, compilation
from rvmon.spec.syntax.expressions import Ident
from rvmon.spec.syntax.items import (
    ConstItem,
    CoverItem,
    CoverpointItem,
    CrossItem,
    DefineItem,
    EventItem,
    Item,
    ParsedSpec,
    PropertyItem,
    RequirementItem,
    SignalItem,
)

_KINDS: dict[type, SymbolKind] = {
    SignalItem: SymbolKind.Variable,
    EventItem: SymbolKind.Event,
    DefineItem: SymbolKind.Function,
    ConstItem: SymbolKind.Constant,
    RequirementItem: SymbolKind.Class,
    PropertyItem: SymbolKind.Property,
    CoverItem: SymbolKind.Key,
    CoverpointItem: SymbolKind.Enum,
    CrossItem: SymbolKind.Array,
}
_SEVERITIES = {
    findings.Severity.ERROR: DiagnosticSeverity.Error,
    findings.Severity.WARNING: DiagnosticSeverity.Warning,
}
