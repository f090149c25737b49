r"""The panels for a state of the point contact: fine at the edge of the dry contact, coarser away from it, few far out.

The edge layer is as wide as :math:`\max(\lambda^{2/5}, \kappa^{2/3})`, as on the line; from there the panels grow to both
sides, as the pressure goes as the square root of the distance.  Widths are rounded to powers of two, so that neighbours share
their mesh, and operators are kept with it.
"""

from __future__ import annotations

import math
import threading
from collections import OrderedDict
from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw, local_decay_length
from stribeck.contacts.groups import BASE_MODEL, Model
from stribeck.equations.point.system import LOAD, Operators
from stribeck.equations.point.thinning_far_field import FarThinned, usual_rate
from stribeck.fluids.fluid import Cavitation
from stribeck.fluids.shear_thinning import ShearThinning
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.settings import (
    BAND,
    COARSE_STEP,
    FAR_GROWTH,
    HALF_DIGITS,
    LEGENDRE_DECAY,
    MAX_BYTES,
    MAX_MODES,
    MAX_REFINEMENTS,
    MAX_STEPS,
    MODES_RATIO,
    NEGLIGIBLE,
    PANEL_GROWTH,
)
from stribeck.quantities.outcome import Outcome
from stribeck.solids.plane import BODIES

RIM_RADIUS = 2.0 * FAR_GROWTH**2  # Radius of the rim over the scale of the contact

MIN_PANEL_WIDTH = NEGLIGIBLE * math.pi / MAX_MODES  # Width below which panels are not split [a]: angles would not tell more


class MeshTooLargeError(Exception):
    """A mesh would take more memory than allowed."""

    outcome = Outcome.MESH_LIMIT


@dataclass(frozen=True)
class Resolution:
    """The parameters of a mesh."""

    halvings: int  # The smallest panel is 2**-halvings scales wide
    doublings: int  # The scale of the contact is 2**doublings Hertz radii
    degree: int  # Degree of the polynomials on a panel
    modes: int  # Number of cosines
    splits: tuple[float, ...] = ()  # Radii at which panels are split besides [a]
    model: Model = BASE_MODEL  # Fluid, cavitation and solid, whose equations are solved on the mesh
    farther: int = 0  # Number of panels beyond the usual rim, for a fluid that thins far out, or a long cavity
    far_growth: float = math.inf  # Largest width of panels beyond twice the scale over their radius

    @property
    def mesh(self) -> PolarMesh:
        """The mesh."""
        body = BODIES[type(self.model.solid)]
        edge = 1.0 if self.doublings else body.edge(self.model.solid)
        width, inner, outer = 0.5**self.halvings, [edge], [edge]
        w = width
        while inner[-1] - w > 0.3 * w:
            inner.append(inner[-1] - w)
            w *= PANEL_GROWTH
        w = width
        while outer[-1] + 1.4 * w < 2.0:
            outer.append(outer[-1] + w)
            w *= PANEL_GROWTH
        near, far = np.concatenate([[0.0], inner[::-1], outer[1:]]), self._far
        scale = 2.0**self.doublings
        near = np.unique(np.concatenate([near * scale, [r for r in self.splits if 0.0 < r < 2.0 * scale]]))
        widest = body.widest_panel(self.model.solid)
        while (wide := np.flatnonzero(np.diff(near) > widest)).size:
            near = np.sort(np.append(near, 0.5 * (near[wide] + near[wide + 1])))
        far = far * scale
        while (wide := np.flatnonzero(np.diff(far) > self._widest_far(far[:-1], widest))).size:
            far = np.sort(np.append(far, np.sqrt(far[wide] * far[wide + 1])))
        return PolarMesh(np.concatenate([near, far]), near.size, self.degree, self.modes)

    def _widest_far(self, radii: Array, widest: float) -> Array:
        """Return the largest width of far panels from these radii on."""
        return min(max(widest, PANEL_GROWTH - 1.0), self.far_growth) * radii

    @property
    def _far(self) -> Array:
        """Radii of the far panels over the scale."""
        return np.append(2.0, RIM_RADIUS * FAR_GROWTH ** np.arange(-1, self.farther + 1))

    def coarser(self) -> Resolution:
        """Return a resolution coarser in radius and angle, whose results show the error of this one's."""
        modes = max(4, round(self.modes / MODES_RATIO)) if self.is_full else self.modes // 2
        return replace(self, degree=self.degree - 2, modes=modes)

    def finer(self) -> Resolution:
        """Return a resolution finer in radius and angle."""
        # Errors of a film that ends fall slowly.
        if not self.is_full:
            return replace(self, degree=self.degree + 1, modes=max(self.modes + 10, in_tens(MODES_RATIO * self.modes)))
        return replace(self, degree=self.degree + 2, modes=2 * math.ceil(0.5 * MODES_RATIO * self.modes))

    def leaner(self) -> Resolution:
        """Return a resolution that has about this one as its finer one."""
        if self.is_full:
            return self.coarser()
        return replace(self, degree=self.degree - 1, modes=in_tens(self.modes / MODES_RATIO))

    @property
    def is_full(self) -> bool:
        """Whether the film is full everywhere."""
        return self.model.cavitation is Cavitation.NONE


def in_tens(modes: float) -> int:
    """Return a number of modes for a film that ends."""
    # The rays along which it ruptures far away lie midway between nodes on any multiple of five angles, so on ten and on half.
    return 10 * max(1, round(0.1 * modes))


def film_scale(speed: float) -> float:
    """Return an estimate of the central film of a smooth contact: only meshes and first guesses depend on it."""
    thin = 0.42 * speed**0.6 / math.sqrt(1.0 + 0.57 * speed**0.2)
    return float(max(thin, 0.18 * speed**0.8))


def film_speed(speed: float, model: Model) -> float:
    """Return the speed at which a Newtonian fluid has about the same film as the fluid of a model, in a smooth contact."""
    film = model.film
    if not isinstance(film, ShearThinning) or not speed > 0.0:
        return speed
    found = speed
    for _ in range(MAX_STEPS):  # a thinner film is sheared faster
        rate = np.array([usual_rate(film.law, film.slide, speed, film_scale(found))])
        found = math.sqrt(found * speed * float(film.law.stress(rate)[0] / rate[0]))
    return found


def gaps_at(law: ContactLaw, log_pressures: Array) -> Array:
    """Return the positive gaps at which a law has these contact pressures, to 1e-7 by bisection; tiny if there is none."""
    decay = float(np.max(law.decay_length))
    low, high = np.full_like(log_pressures, 1e-12 * decay), np.full_like(log_pressures, 1e6 * decay)
    with np.errstate(all="ignore"):
        for _ in range(28):  # of 18 decades
            middle = np.sqrt(low * high)
            above = law.log_pressure(middle) > log_pressures
            low, high = np.where(above, middle, low), np.where(above, high, middle)
    return low


def layout(speed: float, law: ContactLaw, model: Model = BASE_MODEL) -> tuple[float, float]:
    """Return the width of the smallest panel over the scale of the contact, and that scale [a]."""
    speed = film_speed(speed, model)
    decay = float(np.max(law.decay_length))
    height = film_scale(speed) + cavitation_thickening(speed, model)
    if decay > 0.0:
        at_edge = gaps_at(law, np.log(np.array([NEGLIGIBLE])))
        decay = min(decay, float(np.max(local_decay_length(law, at_edge))))
        height = max(height, decay)
    scale = math.sqrt(1.0 + 2.0 * height)
    scale = 1.0 if scale < 1.5 else scale
    return min(0.5, max(speed**0.4, decay ** (2.0 / 3.0)) / MODES_RATIO), scale


def is_too_thin(speed: float, law: ContactLaw) -> bool:
    """Return whether film and roughness are so thin that no mesh within the limits has enough angles."""
    return film_scale(speed) > float(np.max(law.decay_length)) and layout(speed, law)[0] < MIN_PANEL_WIDTH


def rigid_height(speed: float) -> float:
    """Return the height of a rigid ball whose film has the pressure of its full film where that is positive."""
    # The integral of 0.2 speed x/(z + r**2/2)**2 over half the plane is 0.2 speed pi sqrt(2/z).
    return 2.0 * (0.2 * math.pi * speed / LOAD) ** 2


def cavitation_thickening(speed: float, model: Model) -> float:
    """Return an estimate of the factor by which a fast film is thicker because the pressure behind the ball is bounded."""
    if model.cavitation is Cavitation.NONE:
        return 0.0
    rigid = rigid_height(speed)
    if not model.cavity_pressure < 0.0:
        return rigid
    # Behind a rigid ball at a height z the largest suction is that at r**2 = 2 z/3.
    suction = 0.2 * speed * math.sqrt(2.0 / 3.0) * 0.75**2
    return float(min(rigid, (suction / -model.cavity_pressure) ** (2.0 / 3.0)))


def resolution(speed: float, law: ContactLaw, degree: int, modes: int, model: Model = BASE_MODEL) -> Resolution:
    """Return the resolution of a state."""
    width, scale = layout(speed, law, model)
    halvings, doublings = math.ceil(-math.log2(width)), round(math.log2(scale))
    growth = PANEL_GROWTH - 1.0 if model.cavity_pressure < 0.0 else math.inf
    return Resolution(halvings, doublings, degree, modes, (), model, farther_panels(speed, model), growth)


def farther_panels(speed: float, model: Model) -> int:
    """Return the number of panels outside RIM_RADIUS until the film is Newtonian and its suction far from that of a cavity."""
    # Far out the suction is 0.8 speed/r**3.
    film, needed = model.film, 0
    if not speed > 0.0:
        return 0
    if isinstance(film, ShearThinning):
        for needed in range(MAX_REFINEMENTS):
            far = FarThinned(film.law, film.slide, speed, RIM_RADIUS * FAR_GROWTH**needed, 1)
            # A film that ends has no far film that thins.
            left = far.drag if model.cavitation is Cavitation.EXIT else far.friction_error(0.0)
            if left <= COARSE_STEP * speed:
                break
    if model.cavitation is Cavitation.EXIT:  # rounding would decide which nodes of a lower pressure cavitate
        needed = min(needed, math.floor(_panels_to((speed / HALF_DIGITS) ** (1 / 3))))
    if model.cavity_pressure < 0.0:
        needed = max(needed, math.ceil(_panels_to((0.8 * speed / (NEGLIGIBLE * -model.cavity_pressure)) ** (1 / 3))))
    return int(np.clip(needed, 0, MAX_REFINEMENTS))


def _panels_to(radius: float) -> float:
    """Return how many panels beyond the usual rim reach to a radius."""
    return math.log(radius / RIM_RADIUS) / math.log(FAR_GROWTH)


def fits(found: Resolution, speed: float, law: ContactLaw) -> bool:
    """Return whether the panels of a neighbour serve a state, the smallest being at most a third too wide."""
    width, scale = layout(speed, law, found.model)
    excess = math.log2(width) + found.halvings
    if not 0 <= found.farther - farther_panels(speed, found.model) <= 2:
        return False
    return -0.4 <= excess <= 2.1 and abs(math.log2(scale) - found.doublings) <= 0.8


def split_where_poor(found: Resolution, mesh: PolarMesh, fluid: Array, contact: Array) -> Resolution:
    """Return a resolution with the panels halved on which nodal pressures, shape (..., rings), are far from resolved."""
    # A law that saturates, or nearly full contact in the middle, has an edge of its own within the contact.
    fields = np.stack([fluid, fluid + contact]).reshape(-1, mesh.rings)
    tail = np.abs(mesh.legendre(fields)[..., -2:]).max(axis=(0, 2))
    near, widths = mesh.edges[1:] <= 2.0 * 2.0**found.doublings * (1.0 + 1e-9), np.diff(mesh.edges)
    poor = np.flatnonzero(near & (tail > LEGENDRE_DECAY ** (-mesh.degree / MODES_RATIO)) & (widths > MIN_PANEL_WIDTH))
    if poor.size == 0:
        return found
    middles = 0.5 * (mesh.edges[poor] + mesh.edges[poor + 1])
    return replace(found, splits=tuple(sorted({*found.splits, *middles.tolist()})))


def bytes_of(found: Resolution) -> int:
    """Return an estimate of the memory of operators and preconditioner."""
    rings, band = found.mesh.rings, min(BAND, found.modes - 1)
    return found.modes * rings * rings * (8 + 4 * (2 * band + 1)) + 5 * (band + 1) ** 2 * rings * rings


_kept: OrderedDict[Resolution, Operators] = OrderedDict()
_lock = threading.Lock()


def operators_of(found: Resolution) -> Operators:
    """Return the operators of a resolution; the last ones are kept."""
    found = replace(found, model=replace(BASE_MODEL, solid=found.model.solid))
    with _lock:
        if found in _kept:
            _kept.move_to_end(found)
            return _kept[found]
    # They are made without the lock: a process that is forked meanwhile would find it taken for good.
    operators = Operators(found.mesh, found.model.solid)
    with _lock:
        for kept, of_more in _kept.items():  # more angles on the same radii, whose modes begin with these
            if kept.modes > found.modes and replace(kept, modes=found.modes) == found and "deflection" in vars(of_more):
                vars(operators)["deflection"] = of_more.deflection[: found.modes].copy()
        operators = _kept.setdefault(found, operators)
        while len(_kept) > 1 and sum(_size(one) for one in _kept.values()) > NEGLIGIBLE * MAX_BYTES:
            _kept.popitem(last=False)
        return operators


def _size(operators: Operators) -> int:
    return 8 * operators.mesh.modes * operators.mesh.rings**2
