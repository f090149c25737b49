"""The table ``[bench]`` of a case, and the options of ``stribeck bench``: how the raw files of a rig are read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from stribeck.cases.fit_settings import FitSettings, keys_of_fit
from stribeck.cases.tables import AS_GIVEN, Key, Keys, read_tables
from stribeck.fluids.presets import PRESETS
from stribeck.quantities.schema import Input
from stribeck.quantities.units import InputError, checked_kind, checked_word, show

# What both tables say of data files, under the same name.
SHARED = ("columns", "units", "header_row", "sheet", "track_radius", "arm", "run_in", "files")

PER_DECADE = Input(
    name="per_decade", label="bins per decade", dimension="number", typical="10", lowest=1, highest=1000, zero=True
)


def with_bench_keys(settings: FitSettings, given: Mapping[str, Any], table: str = "") -> FitSettings:
    """Return what ``[fit]`` says of data files, with the keys of ``[bench]`` that are given, or its table, in their place."""
    of_fit, problems = keys_of_fit(settings.geometry, "bench"), list[str]()
    keys: Keys = {
        **{name: of_fit[name] for name in SHARED},
        "name": of_fit["file_names"],
        "per_decade": Key(lambda name, value: PER_DECADE.checked(value)),
        "fluid": Key(lambda name, value: _liquid(value)),
        "temperature": AS_GIVEN,
    }
    read = read_tables({table: given.get(table, {})} if table else given, {table: keys}, problems)
    if problems:
        raise InputError("\n".join(problems))
    found = read.get(table, {}) if table else read
    liquid = found.pop("fluid", settings.liquid)
    if "temperature" in found:
        liquid = liquid | {"temperature": found.pop("temperature")}
    if "name" in found:
        found["file_names"] = found.pop("name")
    return replace(settings, liquid=liquid, **found)


def _liquid(fluid: Any) -> dict[str, Any]:
    """Return a liquid and its conditions, as ``iso-vg grade=46`` or a table gives them, as the table ``[fluid]``."""
    if isinstance(fluid, str):
        word, *rest = fluid.split()
        if not all("=" in each for each in rest):
            raise InputError(f"fluid = {show(fluid)}; write a liquid and its conditions, as 'iso-vg grade=46'.")
        given: dict[str, Any] = {"preset": word, **dict(each.split("=", 1) for each in rest)}
    else:
        given = dict(checked_kind("fluid", fluid, Mapping, "text as 'iso-vg grade=46', or a mapping"))
    preset = PRESETS[checked_word("fluid", given.get("preset", ""), tuple(PRESETS))]
    if "temperature" not in preset.conditions:
        raise InputError(
            f"fluid = {show(fluid)} has its viscosity at one temperature only; take a liquid of which more is known."
        )
    preset(**{key: value for key, value in given.items() if key != "preset"})  # refuses what it does not know
    return given
