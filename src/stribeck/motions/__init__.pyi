"""The public names with their types; at run time each is imported on first use."""

from stribeck.motions.ramp import Ramp
from stribeck.motions.sine import Sine
from stribeck.motions.stop import Stop
from stribeck.motions.table import Table

__all__ = ["Ramp", "Sine", "Stop", "Table"]
