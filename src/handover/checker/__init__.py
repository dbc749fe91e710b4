"""The checker: the requirements of the robots, and the model that their runs are held against."""

from handover.checker.specs import SPECS, situations_path, spec_path

__all__ = ["SPECS", "situations_path", "spec_path"]
