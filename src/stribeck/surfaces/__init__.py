"""Surfaces: from measured heights to a spectrum and a contact law."""

from stribeck.contact_laws.persson import PerssonLaw, exponential_limit, persson_law
from stribeck.contact_laws.spectrum import SelfAffine, Spectrum
from stribeck.surfaces.analysis import Surface, analyse
from stribeck.surfaces.departures import Departures
from stribeck.surfaces.detrend import Form, detrended
from stribeck.surfaces.files import read_topography
from stribeck.surfaces.measured_spectrum import MeasuredSpectrum, power_spectrum
from stribeck.surfaces.self_affine_fit import Estimate, SelfAffineFit, fit_self_affine
from stribeck.surfaces.several_scans import CombinedSurface, combine, write_surface_table
from stribeck.surfaces.topography import Topography, synthetic_topography

__all__ = [
    "CombinedSurface",
    "Departures",
    "Estimate",
    "MeasuredSpectrum",
    "PerssonLaw",
    "SelfAffine",
    "SelfAffineFit",
    "Form",
    "Spectrum",
    "Surface",
    "Topography",
    "analyse",
    "combine",
    "detrended",
    "exponential_limit",
    "fit_self_affine",
    "persson_law",
    "power_spectrum",
    "read_topography",
    "synthetic_topography",
    "write_surface_table",
]
