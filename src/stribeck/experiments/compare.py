r"""Which contact law, cavitation or fluid measured friction prefers, and by how much.

.. math:: \mathrm{AICc} = -2 \ln L + 2 k + \frac{2 k (k + 1)}{n - k - 1}, \qquad w \propto e^{-\mathrm{AICc}/2}
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

from stribeck.cases.case import Case
from stribeck.cases.law import INPUTS_OF_SURFACES, KEYS_OF_SURFACES
from stribeck.cases.model_parts import FILES, FLUID_KINDS, SOURCES_OF_VISCOSITY, fluid_table
from stribeck.cases.reading import load_case
from stribeck.contact_laws.finite_surface import FiniteSurface, has_endless_tail
from stribeck.contact_laws.greenwood import GreenwoodTripp, GreenwoodWilliamson
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contact_laws.scaled import NAMED_LAWS
from stribeck.contacts.contact import Contact
from stribeck.files.results import Exported, Labelled, Record, columns_of_records, json_of
from stribeck.files.toml import toml_text
from stribeck.files.writing import PathLike
from stribeck.fits.case_file import case_of, write_fitted_case
from stribeck.fits.fit import fit, names_to_fit
from stribeck.fits.measurements import Data, Measurements, read_measurements
from stribeck.fits.result import Fit
from stribeck.fluids.rheology.eyring import Eyring
from stribeck.fluids.rheology.rate_laws import Carreau
from stribeck.quantities.formats import format_percent
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.results import Card, Told
from stribeck.quantities.units import InputError, checked_kind, show
from stribeck.solver.solve_error import SolveError

# Caveats of a comparison.
CAVEATS = (
    "The weights say which of these is nearest to the data, not that it is right: look at the residuals of the best.",
    "They hold if errors of rows are independent; a systematic error of the rig counts as evidence otherwise.",
    "Contact laws differ most where asperities are few, near the minimum: without rows there data cannot distinguish them.",
)

EXCLUDED_AICC = 10.0  # Difference of AICc from which a law is practically excluded


@dataclass(frozen=True)
class Candidate(Record):
    """One law or model, fitted."""

    name: Annotated[str, "law or model", "1"]
    fit: Annotated[Fit, "its fit"]
    aicc: Annotated[float, "corrected information criterion of Akaike", "1"]
    difference: Annotated[float, "excess over the smallest", "1"]
    weight: Annotated[float, "relative probability among what is compared", "1"]

    _properties = {"noise": ("1", "scatter of the data about the fit")}

    @property
    def noise(self) -> float:
        """Scatter of the data about the fit, see :class:`Fit`."""
        return self.fit.noise


@dataclass(frozen=True, repr=False)
class Comparison(Exported, Told):
    """Laws or models fitted to the same data, the preferred first; its dataset has their criteria along ``law``."""

    _picture = "stribeck.plot.experiments.plot_comparison"

    candidates: Annotated[tuple[Candidate, ...], "what was fitted"]
    failed: Annotated[dict[str, str], "what could not be fitted, and why"]

    @property
    def sentence(self) -> str:
        """The preferred law, in a sentence."""
        best, *others = self.candidates
        if not others:
            return f"Only {best.name} could be fitted."
        if others[0].difference < 2:
            near = [each.name for each in self.candidates if each.difference < 2]
            return f"The data do not distinguish {' and '.join(near)} (differences of AICc below 2)."
        out = [each.name for each in others if each.difference > EXCLUDED_AICC]
        excluded = f"; practically excluded: {', '.join(out)}" if out else ""
        return f"The data prefer {best.name}, by {others[0].difference:.1f} in AICc over {others[0].name}{excluded}."

    def _card(self) -> Card:
        rows = []
        for each in self.candidates:
            noise = format_percent(each.noise) if each.fit.logarithmic and math.isfinite(each.noise) else ""
            rows.append((each.name, f"{each.aicc:.1f}", f"{each.difference:.1f}", f"{each.weight:.2g}", noise))
        head = "law", "AICc", "difference", "weight", "noise"
        return Card(self.sentence, [*self.failed.items()], CAVEATS, [head, *rows])

    def to_dict(self) -> dict[str, Any]:
        """Return the laws with their criteria and values, ready for JSON."""
        laws = [each.to_dict() | {"values": each.fit.to_si()} for each in self.candidates]
        units = {one.label: one.unit or "1" for each in self.candidates for one in each.fit.inputs}
        units |= {name: unit for name, (unit, _) in Candidate._labels.items()}
        return json_of(self, "failed sentence", laws=laws, caveats=CAVEATS, units=units)

    def _labelled(self) -> Labelled:
        columns = columns_of_records("law", self.candidates, Candidate._labels)
        names = {"law": columns.pop("name")}
        failed = "\n".join(f"{name}: {why}" for name, why in self.failed.items())
        return columns, names, {"title": "Comparison of fits", "sentence": self.sentence, "failed": failed}


@answers_typos
def compare(
    data: Data,
    case: PathLike | Case | Contact,
    *,
    laws: Mapping[str, AsperityLaw | None] | None = None,
    models: str | Mapping[str, Mapping[str, Any]] | None = None,
    free: Sequence[str] | None = None,
    on_step: Callable[[str, int, int], object] | None = None,
) -> Comparison:
    """Fit measured friction with several contact laws or models, and return which it prefers, and by how much.

    Parameters
    ----------
    data : path-like or Measurements, or sequence of these
        Measured friction.
    case : path-like, Case or Contact
        The contact.
    laws : mapping, optional
        Laws by name; by default that of the case, its variant with the tail of a finite surface, and those of Greenwood and
        Williamson and of Greenwood and Tripp (at alpha = 1: their separations are in heights).
    models : {"cavitation", "fluid"} or mapping, optional
        What is compared in place of laws: a full film and one that ends at a free exit; a Newtonian fluid and those of Carreau
        and Eyring, with their numbers free; or what differs from the contact by name, as in
        ``{"full film": {}, "exit": {"cavitation": "exit"}}``, arguments of :meth:`LineContact.replace`.  The key ``free`` then
        names inputs that are free in this one beside the others.
    free : sequence of str, optional
        Inputs to fit; those of the case.  ``beta`` is freed with each law, as it has another meaning in each.
    on_step : callable, optional
        ``on_step(what, done, total)`` is called as the work goes on, as by :func:`stribeck.fit`: the name of the law or model
        stands before what it does, and states are those of all fits.

    Returns
    -------
    Comparison
        The laws or models, the preferred first.

    Raises
    ------
    InputError
        If the data or the case cannot be used, or no law be fitted.

    Notes
    -----
    Source: Burnham and Anderson, Model Selection and Multimodel Inference (2002).
    """
    case = case_of(data, case)
    contact, settings = case.contact, case.fit
    rows = read_measurements(data, settings)
    names = names_to_fit(free, settings, contact)
    if models is not None and laws is not None:
        raise InputError("laws and models are both given; a model may have a law: {'name': {'law': ...}}.")
    found: dict[str, Fit] = {}
    failed: dict[str, str] = {}
    compared = _of_laws(contact, laws) if models is None else _models(models, contact, rows)
    solved: dict[str, int] = {}  # by the fits so far
    for number, (name, model) in enumerate(compared.items(), 1):

        def step(what: str, done: int, total: int, name: str = name, number: int = number) -> None:
            solved[name] = done
            before = sum(solved.values()) - done
            if on_step is not None:
                on_step(f"{name}: {what}", before + done, before + total * (1 + len(compared) - number))

        changed = contact.replace(**{key: value for key, value in model.items() if key != "free"})
        inputs = tuple(dict.fromkeys((*names, *model.get("free", ()))))
        try:
            each = fit(rows, replace(case, contact=changed), free=inputs, intervals=False, on_step=step)
        except (InputError, SolveError) as why:
            failed[name] = str(why)
            continue
        fewest = _fitted_numbers(each) + 2
        if not each.outcome.ok:
            failed[name] = each.outcome.value
        elif len(rows) < fewest:
            failed[name] = (
                f"{len(rows)} rows are too few to judge {fewest - 2} fitted numbers, the noise counting as one; give {fewest} "
                "rows or more, or free fewer inputs."
            )
        else:
            found[name] = each
    if not found:
        raise InputError(f"nothing could be fitted: {' '.join(dict.fromkeys(failed.values()))}")
    criteria = {name: _aicc(each) for name, each in found.items()}
    least = min(criteria.values())
    weights = {name: math.exp(-(value - least) / 2) for name, value in criteria.items()}
    total = sum(weights.values())
    order = sorted(found, key=lambda name: criteria[name])
    return Comparison(
        tuple(Candidate(n, found[n], criteria[n], criteria[n] - least, weights[n] / total) for n in order), failed
    )


def _of_laws(contact: Contact, laws: Mapping[str, AsperityLaw | None] | None) -> dict[str, dict[str, Any]]:
    """Return models that differ in their contact law, with beta free in each."""
    found: dict[str, dict[str, Any]] = {}
    given = (
        _laws(contact)
        if laws is None
        else checked_kind("laws", laws, Mapping, "a dictionary, as {'summits': GreenwoodTripp()}")
    )
    for name, law in given.items():
        in_heights = isinstance(law, GreenwoodWilliamson | GreenwoodTripp)
        found[name] = {"law": law, "free": ("beta",), **({"alpha": 1.0} if in_heights else {})}
    return found


def _models(models: str | Mapping[str, Mapping[str, Any]], contact: Contact, rows: Measurements) -> dict[str, Any]:
    """Return the models that are compared: those given, or those of a name."""
    if not isinstance(models, str):
        for each in (models, *(models.values() if isinstance(models, Mapping) else ())):
            checked_kind("models", each, Mapping, "a dictionary of dictionaries, as {'a name': {'beta': 0.05}}")
        return dict(models)
    if models == "cavitation":
        return {name: {"cavitation": each, "cavity_pressure": 0.0} for name, each in (("full film", "none"), ("exit", "exit"))}
    if models == "fluid":
        return _fluids(contact, rows)
    raise InputError(f"models = {show(models)} must be 'cavitation' or 'fluid', or in Python a mapping from names to models.")


def _fluids(contact: Contact, rows: Measurements) -> dict[str, Any]:
    """Return fluids that begin to thin at the shear rate of a film as thick as the roughness, at the middle of the data."""
    speed = contact.speed if rows.abscissa != "speed" else math.sqrt(float(rows.values.min() * rows.values.max()))
    rate = speed / max(contact.roughness, 1e-3 * contact.hertz.indentation)
    return {
        "newtonian": {"fluid": "newtonian"},
        "carreau": {"fluid": Carreau(1 / rate, 0.7), "free": ("relaxation_time", "exponent")},
        "eyring": {"fluid": Eyring(contact.viscosity * rate), "free": ("eyring_stress",)},
    }


def _laws(contact: Contact) -> dict[str, AsperityLaw | None]:
    """Return the laws that are compared by default."""
    own = "exponential" if contact.law is None else contact.law.name
    laws: dict[str, AsperityLaw | None] = {own: contact.law}
    if has_endless_tail(contact.law):
        tail = FiniteSurface(contact.alpha, contact.law if own == "persson" else None)
        laws[tail.name] = tail
    return laws | {"greenwood-williamson": GreenwoodWilliamson(), "greenwood-tripp": GreenwoodTripp()}


def _fitted_numbers(found: Fit) -> int:
    """Return how many numbers were fitted: the inputs, and the noise where it was not given."""
    return len(found.inputs) + (not math.isnan(found.noise))


def _aicc(found: Fit) -> float:
    """Return the corrected information criterion of rows two more than the fitted numbers at the least."""
    n, k = len(found.data), _fitted_numbers(found)
    deviance = float(found._minimum.objective.loss(found.residuals).sum())
    if found.robust and not math.isnan(found.noise):
        deviance += n * math.log(found.noise**2)
    elif not math.isnan(found.noise):  # the noise of the largest likelihood is the root of the mean square
        deviance = n * math.log(found.noise**2 * deviance / n)
    return deviance + 2 * k + 2 * k * (k + 1) / (n - k - 1)


def write_preferred_case(comparison: Comparison, case: Case, path: PathLike, *, force: bool = False) -> str:
    """Write the case of the first law or model that a case file can have, and return its name."""
    for each in comparison.candidates:
        tables = _tables_of(case, each.fit.contact)
        if tables is None:
            continue
        with TemporaryDirectory(prefix="stribeck-") as folder:
            changed, of_case = Path(folder) / "case.toml", case
            if tables != case.tables:  # of the correlations those are written whose errors the file still has
                correlations = tables.pop("correlations", {})
                changed.write_text(toml_text(tables), encoding="utf-8")
                of_case = load_case(changed)
                of_case = replace(of_case, tables=of_case.tables | {"correlations": correlations})
            write_fitted_case(each.fit, of_case, path, force=force)
        return each.name
    names = " or ".join(each.name for each in comparison.candidates)
    raise InputError(f"{path} is not written: no case file can have {names}; write the criteria, as in --out laws.csv.")


def _tables_of(case: Case, contact: Contact) -> dict[str, Any] | None:
    """Return the tables of a case with law, fluid and cavitation of a contact; None where no file can have its law."""
    tables, own = dict(case.tables), case.contact
    law, of_case = ("exponential" if each.law is None else each.law.name for each in (contact, own))
    if law != of_case:
        if law not in NAMED_LAWS:
            return None
        tables = {name: table for name, table in tables.items() if name not in KEYS_OF_SURFACES}
        given = {key: value for key, value in tables["contact"].items() if key not in ("ra", "rq")}
        new = {name: value for name in INPUTS_OF_SURFACES if (value := getattr(contact, name)) != getattr(own, name)}
        tables["contact"] = {name: getattr(own, name) for name in INPUTS_OF_SURFACES} | given | {"law": law} | new
    if contact.fluid.name != own.fluid.name:
        if not SOURCES_OF_VISCOSITY.keys().isdisjoint(tables.get("fluid", {})):
            tables["contact"] = tables["contact"] | {"viscosity": contact.viscosity}
        tables["fluid"] = fluid_table(contact.fluid) or {"model": FLUID_KINDS["rheology"].nothing}
    if (contact.cavitation, contact.cavity_pressure) != (own.cavitation, own.cavity_pressure):
        tables["cavitation"] = {"model": contact.cavitation.value, "cavity_pressure": contact.cavity_pressure}
    for table, key in FILES:
        if tables != case.tables and isinstance(tables.get(table, {}).get(key), str):
            tables[table] = tables[table] | {key: str((case.path.parent / tables[table][key]).resolve())}
    return tables
