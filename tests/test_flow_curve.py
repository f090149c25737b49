"""A viscosity measured over the shear rate becomes the law of a fluid, with errors, or is refused in words."""

import numpy as np
import pytest
from command_line import call, case_text

import stribeck as sb

RATE = np.geomspace(0.1, 1000, 25)
TRUE = {
    "newtonian": (0.01, None),
    "power-law": (0.8, sb.fluids.PowerLaw(0.1, 0.6)),
    "cross": (1.0, sb.fluids.Cross(2.0, 0.8, 1e-3)),
    "carreau": (2.0, sb.fluids.Carreau(5.0, 0.4)),
}


def measured(name, seed=1, scatter=0.03):
    viscosity, law = TRUE[name]
    exact = sb.fluids.FlowCurve(RATE, RATE, viscosity, law, {}, 0.0, {}).at(RATE)
    return exact * np.exp(scatter * np.random.default_rng(seed).standard_normal(RATE.size))


@pytest.mark.quick
def test_the_law_of_a_liquid_is_found_with_its_numbers(subtests):
    for name, (viscosity, law) in TRUE.items():
        with subtests.test(name=name):
            found = sb.fluids.flow_curve(RATE, measured(name))
            assert found.fluid.name == name
            assert 0.015 < found.misfit < 0.04 and found.misfit == found.misfits[name]
            assert found.at(RATE) == pytest.approx(measured(name, scatter=0.0), rel=0.03)
            if name == "power-law":
                assert found.law.exponent == pytest.approx(0.6, abs=0.01)
                continue
            assert abs(found.viscosity - viscosity) < 3 * found.errors["viscosity"]
            for number, error in found.errors.items():
                if number != "viscosity":
                    assert abs(getattr(found.law, number) - getattr(law, number)) < 3 * error


@pytest.mark.slow
def test_standard_errors_hold_the_truth_as_often_as_they_say():
    scores = []
    for seed in range(24):
        found = sb.fluids.flow_curve(RATE, measured("carreau", seed), law="carreau")
        scores.append(
            [(found.viscosity - 2.0) / found.errors["viscosity"], (found.law.exponent - 0.4) / found.errors["exponent"]]
        )
    inside = np.mean(np.abs(scores) < 1.96, axis=0)
    assert all(inside >= 0.85) and np.all(np.std(scores, axis=0) > 0.5)


@pytest.mark.quick
def test_errors_count_a_plateau_at_high_rates_that_the_values_hardly_show():
    rate = np.geomspace(0.01, 100, 12)
    exact = 0.05 + 0.95 * (1 + (2 * rate) ** 2) ** -0.25
    found = sb.fluids.flow_curve(rate, exact * np.exp(0.02 * np.random.default_rng(3).standard_normal(12)), law="carreau")
    assert found.law.infinite_viscosity == 0 and abs(found.law.exponent - 0.5) < 3 * found.errors["exponent"] < 0.5


@pytest.mark.quick
def test_a_law_of_a_plateau_that_the_rates_do_not_show_has_a_finite_relaxation_time():
    rate = np.geomspace(0.01, 1000, 9)
    viscosity = rate**-0.5 * np.exp(0.01 * np.random.default_rng(6).standard_normal(rate.size))
    assert sb.fluids.flow_curve(rate, viscosity).law.name == "power-law"
    assert np.isfinite(sb.fluids.flow_curve(rate, viscosity, law="cross").law.relaxation_time)


@pytest.mark.quick
def test_values_that_allow_no_law_are_refused(subtests):
    for name, rate, viscosity, sentence in (
        ("few", RATE[:4], RATE[:4], "4 different rates; a law needs 5"),
        ("thickens", RATE, 1 + RATE, "thicken under shear are not modelled"),
        ("zero", RATE, 0 * RATE, "viscosity holds 0, value 1 of 25"),
        (
            "direction",
            np.where(RATE > 900, -RATE, RATE),
            RATE,
            "rate holds -1000, value 25 of 25; .*the direction",
        ),
        ("nan", RATE, np.full(25, np.nan), "viscosity holds nan"),
        ("shapes", RATE, RATE[:5], "as many numbers"),
        ("text", RATE, "water", "viscosity = 'water' is not made of real numbers"),
    ):
        with subtests.test(name=name), pytest.raises(sb.InputError, match=sentence):
            sb.fluids.flow_curve(rate, viscosity)
    with pytest.raises(sb.InputError, match="law = 'bingham' is not known"):
        sb.fluids.flow_curve(RATE, measured("cross"), law="bingham")


def test_what_the_rates_do_not_show_is_said():
    found = sb.fluids.flow_curve(RATE, measured("power-law"), law="carreau")
    assert any("do not show" in note for note in found.notes)
    scattered = sb.fluids.flow_curve(RATE, measured("cross", scatter=0.4))
    assert any("No law follows" in note for note in scattered.notes)


CASE = case_text({"speed": '"0.1 m/s"', "viscosity": None}, fluid={"flow_curve": '"gum.csv"'})


def test_a_file_of_a_rheometer_is_the_fluid_of_a_case(tmp_path, capsys):
    values = measured("cross")
    lines = [f"{x:.6g};{1e3 * y:.6g};7".replace(".", ",") for x, y in zip(RATE, values, strict=True)]
    (tmp_path / "gum.csv").write_text(
        "Gum, 25 °C\nShear Rate [1/s];Viscosity [mPa·s];Torque [µN·m]\n" + "\n".join(lines) + "\n"
    )
    found = sb.fluids.read_flow_curve(tmp_path / "gum.csv")
    assert found.viscosity == pytest.approx(sb.fluids.flow_curve(RATE, values).viscosity, rel=1e-4)
    case = tmp_path / "case.toml"
    case.write_text(CASE)
    contact = sb.load_case(case).contact
    assert contact.viscosity == found.viscosity and contact.fluid == found.fluid
    answer = call(capsys, "solve", case, "-v", "--rtol", "1e-3")
    assert answer.code == 0 and "from flow_curve = 'gum.csv': Cross through 25 values" in " ".join(answer.out.split())
    gum = 'flow_curve = "gum.csv"'
    for old, new, sentence in (
        (gum, 'flow_curve = "none.csv"', "none.csv"),
        (gum, f'{gum}\nmodel = "bingham"', "bingham"),
        (gum, f'{gum}\nrelaxation_time = "1 s"', "relaxation_time"),
        (gum, "flow_curve = 3", "text in quotes"),
        ("alpha = 2.0", 'alpha = 2.0\nviscosity = "1 Pa*s"', "both given"),
    ):
        case.write_text(CASE.replace(old, new))
        with pytest.raises(sb.InputError, match=sentence):
            sb.load_case(case)
    (tmp_path / "gum.csv").write_text("Shear Rate [1/s];Viscosity\n1;2\n2;3\n")
    case.write_text(CASE)
    with pytest.raises(sb.InputError, match="has no unit"):
        sb.load_case(case)


def test_a_shear_stress_stands_for_the_viscosity_and_a_kinematic_one_is_refused(tmp_path):
    path = tmp_path / "gum.csv"

    def written(header, values):
        path.write_text("\n".join([header, *(f"{x};{y}" for x, y in zip(RATE, values, strict=True))]))
        return path

    for header in ("shear rate [1/s];shear stress [Pa]", "Scherrate [1/s];Schubspannung [Pa]", "Shear rate [1/s];τ [Pa]"):
        found = sb.fluids.read_flow_curve(written(header, RATE * measured("cross")))
        assert found.viscosity == pytest.approx(sb.fluids.flow_curve(RATE, measured("cross")).viscosity, rel=1e-6)
        assert "Viscosity is shear stress over shear rate." in found.notes
    with pytest.raises(sb.InputError, match="none of which is the viscosity; name the columns .* or 'shear stress"):
        sb.fluids.read_flow_curve(written("shear rate [1/s];torque [N m]", RATE))
    with pytest.raises(sb.InputError, match="gum.csv: its viscosity is a kinematic one; multiply the column by the density"):
        sb.fluids.read_flow_curve(written("shear rate [1/s];viscosity [cSt]", RATE))
    for header, wrong, words in (
        ("shear rate [1/s];viscosity [Pa s]", "0;1", "rate holds 0, row 5; all values must be .* Leave out rest"),
        ("shear rate [1/s];shear stress [Pa]", "1;-1", "viscosity holds -1, row 5"),
        ("shear rate [1/s];viscosity [Pa s]", "1;9.9E+37", "viscosity holds 9.9e\\+37, row 5"),
    ):
        lines = written(header, measured("cross")).read_text().splitlines()
        path.write_text("\n".join(["Gum", *lines[:2], ";", wrong, *lines[2:]]))
        with pytest.raises(sb.InputError, match=f"gum.csv: {words}"):
            sb.fluids.read_flow_curve(path)


def test_headings_of_rheometers_name_rate_viscosity_and_stress(subtests, tmp_path):
    values, rate = measured("cross"), "{:.6g}".format
    for header, factors in (
        ("t in s;T in °C;ɣ̇ in 1/s;η in mPas;τ in Pa", (1e3, 1.0)),
        ("t in s\tT in °C\tγ̇ in 1/s\tη in Pas\tτ in Pa", (1.0, 1.0)),
        ("t in s   T in °C   GP in 1/s   Eta in mPas   Tau in Pa", (1e3, 1.0)),
        ("Zeit [s];Temperatur [°C];Schergeschwindigkeit [1/s];Viskosität [mPa·s];Schubspannung [Pa]", (1e3, 1.0)),
        ("Zeit [s];Temperatur [°C];Schergefälle [s-1];Scherviskosität [mPas];Scherspannung [mPa]", (1e3, 1e3)),
        ("Zeit / s;Temperatur / °C;Scherrate / s^-1;dynamische Viskosität / mPa s;τ / Pa", (1e3, 1.0)),
    ):
        mark = next((mark for mark in ";\t" if mark in header), "   ")
        lines = (
            mark.join((str(k), "25", rate(x), rate(factors[0] * y), rate(factors[1] * x * y)))
            for k, (x, y) in enumerate(zip(RATE, values, strict=True))
        )
        path = tmp_path / "gum.csv"
        path.write_text("\n".join([header, *lines]), encoding="utf-8")
        for name in (header, header.replace("η", "X").replace("Eta", "X").replace("iskosität", "X")):
            with subtests.test(name=name):
                path.write_text("\n".join([name, *path.read_text(encoding="utf-8").splitlines()[1:]]), encoding="utf-8")
                found = sb.fluids.read_flow_curve(path)
                assert found.measured == pytest.approx(values, rel=1e-5) and found.rate == pytest.approx(RATE, rel=1e-5)
    with pytest.raises(sb.InputError, match="header is 'n in 1/min, M in mNm', none of which is the shear rate; name the"):
        path.write_text("n in 1/min;M in mNm\n1;2\n")
        sb.fluids.read_flow_curve(path)


def test_a_stress_in_another_unit_than_the_viscosity_is_refused(tmp_path):
    path = tmp_path / "gum.csv"
    header = "shear rate [1/s];shear stress [Pa];viscosity [mPa s]"
    for factor in (1.0, 1e3):
        rows = (f"{x};{x * y};{factor * y}" for x, y in zip(RATE, measured("cross"), strict=True))
        path.write_text("\n".join([header, *rows]))
        if factor == 1e3:
            assert sb.fluids.read_flow_curve(path).measured == pytest.approx(measured("cross"))
        else:
            with pytest.raises(sb.InputError, match="shear stress is 1e\\+03 times viscosity times shear rate"):
                sb.fluids.read_flow_curve(path)


def test_a_law_shows_its_numbers_with_their_errors_and_is_the_fluid_of_a_contact():
    found = sb.fluids.flow_curve(RATE, measured("carreau"))
    rows = [line.split() for line in str(found).splitlines()]
    assert ["viscosity", f"{found.viscosity:.3g}", "Pa*s", f"{1e3 * found.errors['viscosity']:.3g}", "mPa*s"] in rows
    exponent, error = f"{found.law.exponent:.3g}", f"{found.errors['exponent']:.3g}"
    assert ["exponent", "of", "shear", "thinning", exponent, error] in rows
    assert f", power-law {100 * found.misfits['power-law']:.2g} %, " in str(found)
    assert found.inputs == {"viscosity": found.viscosity, "fluid": found.fluid} and found.fluid.rheology == found.law


def test_text_below_the_numbers_of_a_file_is_named_where_a_fit_reads_it_and_refused_where_a_law_does(tmp_path):
    def written(*rows):
        (tmp_path / "a.csv").write_text("\n".join((*rows, "End of data")))
        return tmp_path / "a.csv"

    flow = zip(RATE, measured("cross"), strict=True)
    found = sb.fluids.read_flow_curve(written("rate [1/s];viscosity [Pa s]", *(f"{x};{y}" for x, y in flow), "5;"))
    assert found.notes[:2] == ("1 row below the numbers left out: 28.", "Rows with an empty cell left out: 27.")
    moduli = (f"{x:g};{1 + x / (1 + x)};{x / (1 + x**2)}" for x in np.geomspace(0.01, 100, 20))
    found = sb.solids.from_master_curve(written("frequency [rad/s];E' [MPa];E'' [MPa]", *moduli))
    assert found.notes[0] == "1 row below the numbers left out: 22."
    one = "\n".join(("rate [1/s];viscosity [Pa s]", *(f"{x};1.5" for x in RATE)))
    found = sb.fluids.read_flow_curve(written(one, "", "Interval 2", one))
    assert found.rate.size == 2 * RATE.size and "2 tables with the same header were read as one." in found.notes
    law = written("separation,pressure", *(f"{x},{np.exp(-x)}" for x in range(5)))
    with pytest.raises(sb.InputError, match="no numbers of the table above in row 7; take text out"):
        sb.contact_laws.TableLaw.read(law)
    law.write_text(law.read_text().replace("End", "# End"))
    assert sb.contact_laws.TableLaw.read(law).parameters["rows"] == 5
