"""The public names with their types; at run time each is imported on first use."""

from stribeck.contact_laws.finite_surface import FiniteSurface
from stribeck.contact_laws.function import FunctionLaw
from stribeck.contact_laws.greenwood import GreenwoodTripp, GreenwoodWilliamson
from stribeck.contact_laws.table import TableLaw

__all__ = [
    "FiniteSurface",
    "FunctionLaw",
    "GreenwoodTripp",
    "GreenwoodWilliamson",
    "TableLaw",
]
