"""What the name of a file says: fields of a pattern such as ``{fluid}_{load}N_{run}.csv``."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

from stribeck.contacts.inputs import InputTable
from stribeck.quantities.units import InputError, show

__all__ = ["NamePattern", "Named"]

_FIELD = re.compile(r"\{([^{}]*)\}")
_UNIT = re.compile(r"[A-Za-zµμ%°]+(?=$|[^A-Za-zµμ%°])")


@dataclass(frozen=True)
class Named:
    """What the name of a file says."""

    curve: str = ""  # What names its curve
    run: str = ""  # Number or name of a repeat
    temperature: str = ""  # With its unit
    inputs: dict[str, float] = field(default_factory=dict)  # Inputs of the contact in SI units


@dataclass(frozen=True)
class NamePattern:
    """A pattern of names of files; a unit stands behind its field."""

    text: str
    inputs: InputTable

    def read(self, path: Path) -> Named:
        """Return what the name of a file says; refuse one that does not have the pattern."""
        fields = _FIELD.findall(self.text)
        if not fields or not all(each.isidentifier() for each in fields) or len(set(fields)) < len(fields):
            raise InputError(
                f"name = {show(self.text)} must have fields in braces, each once, as in '{{fluid}}_{{load}}N_{{run}}.csv'."
            )
        pieces = _FIELD.split(self.text)
        units = {
            name: found[0] for name, after in zip(pieces[1::2], pieces[2::2], strict=True) if (found := _UNIT.match(after))
        }
        pattern = "".join(re.escape(each) if i % 2 == 0 else f"(?P<{each}>.+?)" for i, each in enumerate(pieces))
        match = re.fullmatch(pattern, path.name)
        if match is None:
            raise InputError(
                f"{path.name} does not have the pattern {show(self.text)}; change the pattern, or rename the file."
            )
        values, curve, temperature = match.groupdict(), list[str](), ""
        inputs: dict[str, float] = {}
        for name, text in values.items():
            if name == "run":
                continue
            quantity = self.inputs.quantities.get(name)
            with_unit = f"{text.replace(',', '.')} {units.get(name, '')}".strip()
            if name == "temperature":
                temperature = with_unit
            elif quantity is not None and name != "speed":
                inputs[name] = quantity.checked(with_unit)
            curve.append(with_unit if quantity is not None or name == "temperature" else text)
        return Named(" ".join(curve), values.get("run", ""), temperature, inputs)
