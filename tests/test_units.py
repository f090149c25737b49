"""Text with units becomes SI numbers, and everything else becomes a sentence."""

import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from fit_data import TRUE
from hypothesis import given, settings
from hypothesis import strategies as st

import stribeck as sb
from stribeck import InputError

pytestmark = pytest.mark.quick

INPUT_OF = {
    "speed": "speed",
    "length": "radius",
    "pressure": "modulus",
    "viscosity": "viscosity",
    "load": "load",
    "number": "alpha",
}
"""The input of a contact by which each dimension is asked for."""


def to_si(value, dimension):
    """Return what a contact makes of a value."""
    name = INPUT_OF[dimension]
    return getattr(TRUE.replace(**{name: value}), name)


ACCEPTED = [
    ("0.1 m/s", "speed", 0.1),
    ("360 km/h", "speed", 100.0),
    ("10 mm.s^-1", "speed", 0.01),
    ("2.7 N/mm2", "pressure", 2.7e6),
    ("10 mm2 s-1 / mm", "speed", 0.01),
    ("0.5 µm", "length", 0.5e-6),
    ("1um", "length", 1e-6),
    (".5 in", "length", 0.0127),
    ("2.5 um", "length", 2.5e-6),
    ("3 N/mm²", "pressure", 3e6),
    ("300 mbar", "pressure", 3e4),
    ("10 mPa*s", "viscosity", 0.01),
    ("1 cP", "viscosity", 1e-3),
    ("1 kg/(m*s)", "viscosity", 1.0),
    ("0.5 N/mm", "load", 500.0),
    ("5 kg/s**2", "load", 5.0),
]


def test_text_with_a_unit_becomes_its_si_value_and_a_bare_number_is_taken_as_si():
    assert [to_si(text, dimension) for text, dimension, _ in ACCEPTED] == [expected for *_, expected in ACCEPTED]
    for value in (3, 3.0, np.float64(3), np.float32(3), np.int32(3), Fraction(3)):
        result = to_si(value, "load")
        assert result == 3.0 and type(result) is float


# What is refused, and the words that tell why or what to try.
REFUSED = [
    ("3 m", "speed", "is a length; expected a speed such as '1 mm/s'."),
    ("1 cSt", "viscosity", "is a kinematic viscosity; expected a viscosity such as '50 mPa*s': give it as kinematic_"),
    ("Ra 0.2 um", "length", "begins with its kind; write ra = '0.4 um' in place of"),
    ("50 N", "load", "a force is the load of a ball, PointContact or geometry = 'point'; that of a cylinder, LineContact"),
    ("30 deg", "speed", "is an angle; expected a speed"),
    ("1 percent", "length", "is a bare number; expected"),
    ("2 rad/s", "speed", "is a rate; expected a speed such as '1 mm/s': give it as rotational_speed, with the shaft_"),
    ("5 kg", "load", "is a mass; expected a load per unit length such as '30 N/m': a mass presses"),
    ("2 m**3", "length", "is of dimension length^3; expected a length"),
    ("10 mPas", "viscosity", "'mPa*s'"),
    ("1,5 MPa", "pressure", "decimal point"),
    ("0.1", "speed", "has no unit; add one, as in '0.1 m/s'"),
    ("", "speed", "does not begin with a number"),
    ("1e999 m/s", "speed", "not a finite number"),
    ("1e999999999 m/s", "speed", "not a number with a unit"),
    ("9" * 5000 + " m/s", "speed", "not a number with a unit"),
    ("2.1 Mpa", "pressure", "unknown unit 'Mpa' (upper and lower case differ)"),
    ("1 m)/s", "speed", "cannot be read"),
    ("1_000 m", "length", "not a number with a unit"),
    ("1 m**(9**9)", "length", "not a number with a unit"),
    ("1 " + "m*" * 1000 + "m", "length", "not a number with a unit"),
    ("2.0", "number", "text, but a number is expected"),
    ("30 %", "number", "text, but a number is expected; write 0.3."),
    ("70 Shore A", "pressure", "is a hardness, not a modulus; write shore_a = 70 or shore_d = 50"),
    (np.True_, "speed", "not a single real number"),
    ([1.0], "speed", "not a single real number"),
    (np.array(1.0), "speed", "not a single real number"),
    (Decimal("1"), "speed", "not a single real number"),
    (-math.inf, "number", "not a finite number"),
    (10**400, "speed", "not a finite number"),
]


def test_what_is_no_quantity_is_refused_in_one_sentence_with_name_value_and_reason(subtests):
    for value, dimension, reason in REFUSED:
        with subtests.test(value=value, dimension=dimension, reason=reason):
            with pytest.raises(InputError) as caught:
                to_si(value, dimension)
            sentence = str(caught.value)
            assert sentence.startswith(f"{INPUT_OF[dimension]} = {repr(value)[:50]}")
            assert reason in sentence
            assert sentence.endswith(".") and "\n" not in sentence and len(sentence) < 250


def test_strokes_are_counted_not_measured_by_an_angle():
    """An angle is a bare number, so that 120 turns a minute made 12.6 strokes a second."""
    for turning in ("120 rpm", "2 rad/s", "720 deg/s"):
        with pytest.raises(InputError, match="is an angular velocity; expected how often in a time, such as '2 Hz'"):
            sb.motions.Sine(stroke="20 mm", frequency=turning)
    assert sb.motions.Sine(stroke="20 mm", frequency="120 1/min").duration == pytest.approx(0.5)


@settings(derandomize=True, deadline=None, max_examples=300)
@given(st.from_regex(r"[0-9]{1,2} ?[mPaNskgC*/^().0-9µ ]{0,12}", fullmatch=True))
def test_no_text_whatever_gets_past_the_sentences(text):
    try:
        assert math.isfinite(to_si(text, "pressure"))
    except InputError as refusal:
        assert "\n" not in str(refusal)


@settings(derandomize=True, deadline=None, max_examples=200)
@given(value=st.floats(1e-11, 1e11), dimension=st.sampled_from(["speed", "length", "pressure", "viscosity", "load"]))
def test_short_text_reads_back_within_its_digits(value, dimension):
    text = sb.LineContact.INPUTS.text(INPUT_OF[dimension], value)
    assert to_si(text, dimension) == pytest.approx(value, rel=5.01e-3)


def test_short_text_has_a_fitting_prefix(subtests):
    for value, dimension, text in [
        (3.1e-4, "speed", "310 µm/s"),
        (9.996e-4, "length", "999.6 µm"),
        (2.7e6, "pressure", "2.7 MPa"),
        (1e12, "pressure", "1000 GPa"),
        (2.5e16, "pressure", "2.5e+07 GPa"),
        (0.05, "viscosity", "50 mPa·s"),
        (30.0, "load", "30 N/m"),
        (0.0, "speed", "0 m/s"),
        (0.12345, "number", "0.123"),
    ]:
        with subtests.test(value=value, dimension=dimension, text=text):
            assert sb.LineContact.INPUTS.text(INPUT_OF[dimension], value).startswith(text)
