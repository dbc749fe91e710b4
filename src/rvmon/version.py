"""The version, apart from the package that everything else is reached through."""

__version__ = "0.1.0"
