"""The checker: the requirements of the robots, and the model that their runs are held against."""

from handover.checker.specs import SPECS, spec_path

__all__ = ["SPECS", "spec_path"]
