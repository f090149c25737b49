"""What solutions of every geometry share: observables by name, errors, friction, and their entries in files."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import as_asperity_friction
from stribeck.contact_laws.law import WithArea
from stribeck.contacts.contact import Contact, HertzScales, model_words
from stribeck.contacts.friction import Definition, Friction, Regime, check_definition, coefficients, regime_of
from stribeck.contacts.groups import Groups
from stribeck.contacts.notes import law_notes, shape_notes
from stribeck.files.datasets import Column, new_dataset, number_columns
from stribeck.files.results import Exported
from stribeck.numerics.settings import PLACES_AROUND_NODE
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import COLUMNS, OUTPUT_TABLES, OutputTable
from stribeck.quantities.results import ByValue, Card, Shown
from stribeck.quantities.units import InputError
from stribeck.solver.fields import Profile
from stribeck.solver.numbers import about_problem, constant_groups, main_rows, numbers_of, problem_attributes

if TYPE_CHECKING:
    import xarray


class BaseSolution(Exported, Shown, ByValue, ABC):
    """One solved state; see the solution of a geometry for its fields."""

    groups: Groups
    contact: Contact | None
    outcome: Outcome
    notes: tuple[str, ...]
    rtol: float
    law: str
    observables: Any

    def notes_for(
        self, boundary_friction: float | None = None, beta: float | None = None, definition: Definition = "balanced"
    ) -> tuple[str, ...]:
        """Return the notes by one definition of friction, and with coefficients beside groups in place of usual ones."""
        given = None
        if self.contact is None and not (boundary_friction is None and beta is None):
            given = 1.0 if boundary_friction is None else boundary_friction, 1.0 if beta is None else beta
        if (given is None and definition == "balanced") or not self.outcome.ok:
            return self.notes
        problem, shape = (self.groups, self.contact, self.observables), len(shape_notes(self.contact))
        usual = law_notes(*problem)
        others = [note for note in self.notes if note not in usual]
        return (*others[:shape], *law_notes(*problem, given, definition), *others[shape:])

    @property
    @abstractmethod
    def errors(self) -> dict[str, float]:
        """Estimated relative error of each observable; absolute for the load shares."""

    @property
    @abstractmethod
    def error_estimate(self) -> float:
        """Largest estimated relative error of the observables; load shares count absolutely."""

    @property
    @abstractmethod
    def nodes(self) -> int:
        """Unknown gaps in the final discretisation."""

    @property
    @abstractmethod
    def x(self) -> Array:
        """Positions of the nodes along the contact, of a ball along its middle line, ascending [a]."""

    @abstractmethod
    def profile(self, x: Array) -> Profile:
        """Return the fields at positions along the contact [a], in Hertz units."""

    @property
    @abstractmethod
    def _along(self) -> Profile:
        """The fields at :attr:`x`, in Hertz units."""

    @property
    def gap(self) -> Array:
        """Gap at :attr:`x` [u_Hz]."""
        return self._along.gap

    @property
    def contact_pressure(self) -> Array:
        """Contact pressure at :attr:`x` [p_Hz]."""
        return self._along.contact_pressure

    @property
    def fluid_pressure(self) -> Array:
        """Fluid pressure at :attr:`x` [p_Hz]; negative behind the contact where the fluid does not cavitate."""
        return self._along.fluid_pressure

    @property
    def pressure(self) -> Array:
        """Total pressure at :attr:`x` [p_Hz]."""
        return self._along.pressure

    @property
    def separation(self) -> Array:
        """Separation ``s = alpha h/h_rms`` at :attr:`x` [-], in which contact laws are given; infinite for smooth surfaces."""
        kappa = float(self.groups.relative_roughness)
        return self.gap / kappa if kappa > 0 else np.full_like(self.x, np.inf)

    @abstractmethod
    def _viscous(self, beta: float, definition: Definition) -> tuple[float, float]:
        """Return the viscous friction coefficient and its estimated absolute error."""

    @property
    def outputs(self) -> OutputTable:
        """The table of the observables of this geometry."""
        return OUTPUT_TABLES[self.groups.geometry]

    @property
    @abstractmethod
    def _sliding(self) -> float:
        """Fraction of the sliding friction of asperities that acts, with its sign."""

    def _walls(self, beta: float) -> tuple[float, float]:
        """Return the viscous friction coefficients on the substrate and on the other body, nan where they are not known."""
        return math.nan, math.nan

    @cached_property
    def _own(self) -> frozenset[str]:
        return frozenset(self.observables.__dataclass_fields__)

    def __getattr__(self, name: str) -> float:
        """Return an observable under its own name."""
        if not name.startswith("_") and name != "observables" and name in self._own:
            return float(getattr(self.observables, name))
        # Of a property that fails Python asks here, and would show none of what failed.
        return object.__getattribute__(self, name)  # type: ignore[no-any-return]

    def __dir__(self) -> list[str]:
        """Return the names of attributes, observables among them."""
        return [*super().__dir__(), *self._own]

    @property
    def central_film_thickness(self) -> float:
        """Film thickness in the middle of a contact in SI units [m]; of groups it is :attr:`central_gap` in u_Hz."""
        return float(self.central_gap) * self._hertz("central_film_thickness").indentation

    @property
    def minimum_film_thickness(self) -> float:
        """Smallest film thickness of a contact in SI units [m]; of groups it is :attr:`minimum_gap` in u_Hz."""
        return float(self.minimum_gap) * self._hertz("minimum_film_thickness").indentation

    @property
    def maximum_pressure(self) -> float:
        """Largest pressure of asperities and fluid together along a contact in SI units [Pa]."""
        scale = self._hertz("maximum_pressure").pressure
        return float(self._around(int(np.argmax(self.pressure))).pressure.max()) * scale

    @property
    def largest_suction(self) -> float:
        """Largest pressure of the fluid below the ambient along a contact in SI units [Pa]; zero where it is nowhere below."""
        scale = self._hertz("largest_suction").pressure
        return max(0.0, -float(self._around(int(np.argmin(self.fluid_pressure))).fluid_pressure.min())) * scale

    def _around(self, node: int) -> Profile:
        """Return the fields between the neighbours of a node of :attr:`x`."""
        node = min(max(node, 1), len(self.x) - 2)
        return self.profile(np.linspace(self.x[node - 1], self.x[node + 1], PLACES_AROUND_NODE))

    def _scales(self) -> HertzScales:
        """Return the scales in which fields are given in SI units."""
        if self.contact is None:
            kinds = "PointContact" if self.groups.geometry == "point" else "LineContact or PointContact"
            raise InputError(f"to_si needs the Hertz scales of a contact; solve a {kinds} instead of Groups.")
        return self.contact.hertz

    def _hertz(self, name: str) -> HertzScales:
        if self.contact is None:
            raise InputError(
                f"{name} is in SI units, but this state was solved from groups alone: it has gaps in Hertz indentations and "
                "pressures in Hertz pressures, as central_gap. Solve a LineContact or PointContact for SI units."
            )
        return self.contact.hertz

    @property
    def central_separation(self) -> float:
        """Central gap over h_rms/alpha [-], the Lambda of [BP]; infinite for smooth surfaces."""
        kappa = float(self.groups.relative_roughness)
        return self.central_gap / kappa if kappa > 0 else math.inf

    @property
    def lambda_ratio(self) -> float:
        """Minimum film thickness over h_rms [-]; infinite for smooth surfaces.

        Groups alone do not hold alpha: without a contact it is taken as one, and this is the minimum gap over h_rms/alpha.
        """
        kappa = float(self.groups.relative_roughness)
        alpha = 1.0 if self.contact is None else self.contact.alpha
        return self.minimum_gap / (alpha * kappa) if kappa > 0 else math.inf

    @property
    def central_area_fraction(self) -> float:
        """Real area of contact over the apparent one at x = 0 [-]; nan for a law without a spectrum of the surface."""
        return self._central_area()[0]

    @property
    def central_area_fraction_error(self) -> float:
        """Estimated absolute error of :attr:`central_area_fraction` [-], from that of the central gap."""
        return self._central_area()[1]

    def _central_area(self) -> tuple[float, float]:
        law = self.groups.law
        if not isinstance(law, WithArea) or self.groups.roughness == 0:
            return math.nan, math.nan
        error = abs(self.central_gap) * self.errors["central_gap"]
        gaps = np.array([self.central_gap, self.central_gap - error, self.central_gap + error])
        found = law.area_fraction_at(np.exp(law.log_pressure(gaps / float(self.groups.relative_roughness))))
        return float(found[0]), float(np.abs(found[1:] - found[0]).max())

    @property
    def real_contact_area(self) -> float:
        """Real area of contact over that of the dry smooth contact [-]; nan for a law without a spectrum of the surface."""
        return self._real_area[0]

    @property
    def real_contact_area_error(self) -> float:
        """Estimated absolute error of :attr:`real_contact_area` [-], from load and quadrature."""
        return self._real_area[1]

    @cached_property
    def _real_area(self) -> tuple[float, float]:
        if self.groups.roughness == 0:  # all of a dry smooth contact is real, and nothing of a film
            return float(self.contact_load_share), self.errors["contact_load_share"]
        return self._area() if isinstance(self.groups.law, WithArea) else (math.nan, math.nan)

    @abstractmethod
    def _area(self) -> tuple[float, float]:
        """Return the real area of contact of a law that knows it, and its error."""

    @property
    def law_parameters(self) -> dict[str, float | str]:
        """Parameters of the contact law beside alpha, beta and h_rms; none of the exponential one."""
        return {} if self.groups.law is None else self.groups.law.parameters

    @property
    def hersey_number(self) -> float:
        """Hersey number [-], eta U/F_N of a line and eta U R/F_N of a ball with the sum U; of groups that at beta = 1."""
        return float(self.groups.hersey_number() if self.contact is None else self.contact.hersey_number)

    @property
    def friction(self) -> Friction:
        r"""The friction coefficient [-], balanced: a number with its parts ``asperities``, ``fluid`` and its ``error``.

        .. math:: \mu = \mu_0 \frac{F_c}{F_N} + \mu_f(\beta)

        The coefficients are those of the contact, or 1 where only groups are known.  ``friction(boundary_friction, beta,
        definition)`` returns it for others, each optional.  With the definition ``"balanced"`` the viscous part is the force
        on the substrate, which balances all forces on the other body; with ``"published"`` it is that of the article.
        They agree where asperities carry nothing; in boundary lubrication the published one is larger.

        Notes
        -----
        On the line the viscous part is proportional to beta; on the ball it also holds the logarithm of the slope a/R, see
        :mod:`stribeck.contacts.cut_off`.

        Source: [BP] Eq. (friction); theory.md, section 6, for the balanced form.
        """
        return self._friction()

    @answers_typos
    def _friction(
        self, boundary_friction: float | None = None, beta: float | None = None, definition: Definition = "balanced"
    ) -> Friction:
        boundary_friction, beta = coefficients(self.contact, boundary_friction, beta)
        contact, of_contact = as_asperity_friction(boundary_friction).part(self, self._sliding)
        viscous, error = self._viscous(beta, check_definition(definition))
        error += of_contact
        lower, upper = (contact + wall for wall in self._walls(beta))
        return Friction(contact, viscous, contact + viscous, error, lower, upper, self._friction)

    @property
    def regime(self) -> Regime:
        """Lubrication regime: ``"boundary"``, ``"mixed"`` or ``"hydrodynamic"``, see :func:`stribeck.regime_of`."""
        return regime_of(self.fluid_load_share, self.friction.contact_share)

    def _card(self) -> Card:
        rows = [(each.label, " ".join(filter(None, each.texts))) for each in main_rows(self)]
        model = model_words(self.groups, self.contact)
        rows += [("contact law", self.law), *([("model", model)] if model else [])]
        groups = ", ".join(f"{name} {value:.4g}" for name, value in constant_groups(self.groups).items())
        error = self.friction.relative_error
        shown, of_all = f"{error:.1e}", f"{self.error_estimate:.1e}"
        of_friction = f", of the friction {shown}" if error > self.error_estimate and shown != of_all else ""
        rows += [("groups", groups), ("estimated error", f"{of_all}{of_friction} (rtol {self.rtol:g})")]
        outcome = "" if self.outcome.ok else f"; {self.outcome.value}"
        return Card(f"{self.regime} lubrication{outcome}", rows, self.notes)

    def _columns(
        self, boundary_friction: float | None = None, beta: float | None = None, definition: Definition = "balanced"
    ) -> dict[str, Column]:
        """Return regime and numbers, each with its error, as columns of a dataset."""
        regime = regime_of(self.fluid_load_share, self._friction(boundary_friction, beta, definition).contact_share)
        regimes: dict[str, Column] = {"regime": ((), regime, *COLUMNS["regime"])}
        return regimes | number_columns(numbers_of(self, boundary_friction, beta))

    @answers_typos
    def to_dict(
        self, boundary_friction: float | None = None, beta: float | None = None, definition: Definition = "balanced"
    ) -> dict[str, Any]:
        """Return inputs, the numbers of :meth:`to_dataset` with their errors and units, and the outcome, ready for JSON.

        The error of a number has its name and ``_error``, and its unit.

        Parameters
        ----------
        boundary_friction, beta : float, optional
            As in :meth:`friction`.
        definition : {"balanced", "published"}
            Which friction the regime and the notes go by; the numbers are those of both.

        Returns
        -------
        dict
            Numbers, text, lists and dictionaries of these; None where a number does not exist.
        """
        columns = self._columns(boundary_friction, beta, definition)
        found = about_problem(self.groups, self.contact)
        units = {name: unit for name, (_, _, unit, _) in columns.items() if name != "regime" and not name.endswith("_error")}
        return found | {
            "units": (found["units"] or {}) | units,
            **{f"{name}_group": value for name, value in constant_groups(self.groups).items()},
            **{name: value for name, (_, value, _, _) in columns.items()},
            "rtol": self.rtol,
            "nodes": self.nodes,
            "outcome": self.outcome.name,
            "message": self.outcome.value,
            "notes": self.notes_for(boundary_friction, beta, definition),
        }

    def _with_numbers(self, fields: xarray.Dataset) -> xarray.Dataset:
        """Return the dataset of the fields with the numbers of the state and what they belong to."""
        about = {
            "title": f"State of a lubricated rough {self.groups.geometry} contact",
            "outcome": self.outcome.value,
            "rtol": self.rtol,
            **problem_attributes(self.groups, self.contact, self.law == "smooth"),
            "notes": "\n".join(self.notes),
        }
        return fields.merge(new_dataset(self._columns(), {}, {})).assign_attrs(about)


def regime_of_state(solution: BaseSolution, definition: Definition) -> Regime:
    """Return the regime of a state by a definition of the viscous friction."""
    return regime_of(solution.fluid_load_share, solution.friction(definition=definition).contact_share)
