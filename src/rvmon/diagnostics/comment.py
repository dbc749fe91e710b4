"""Texts of a specification within the comments of generated code."""

from __future__ import annotations

_HARMLESS = {"\\": "/", '"': "'", "*/": "* /", "/*": "/ *"}
"""What would end a comment or a docstring; replaced in this order."""


def comment(text: str) -> str:
    r"""One line that ends no comment of C or Python and no docstring.

    >>> comment('*\\ int x; /*')
    '* // int x; / *'
    """
    text = ascii(text)[1:-1]
    for sign, harmless in _HARMLESS.items():
        text = text.replace(sign, harmless)
    return text
