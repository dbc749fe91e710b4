"""The checker: requirements attached to the simulation's message bus."""

from handover.checker.checker import Checker
from handover.checker.specs import SPECS, spec_path

__all__ = ["SPECS", "Checker", "spec_path"]
