"""The FMU: its description by FMPy, its numbers by FMPy and by hand, its sources under every warning."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from functools import cache, partial
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pint
import pytest

import tir
from mffit.cli import main
from mffit.errors import InputError
from mffit.export import write_c, write_fmu
from mffit.export.variables import UNITS, Interface
from tir import transient
from tir.transient import Contact, step

OUTPUTS = Interface.of(tir.Tyre.from_values({}), transient=False).outputs
VECTORS = Path(__file__).parents[2] / "tir" / "vectors"
FILE = VECTORS / "moto_front.tir"
INPUTS = ("Fz", "kappa", "alpha", "gamma", "phi_t", "Vx", "p")
FORCES = ("Fx", "Fy", "Fz_out", "Mx", "My", "Mz")
COMPILER = next((name for name in ("cc", "gcc", "clang") if shutil.which(name)), None)
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")


def test_inputs_lag_only_where_the_contact_does():
    tyre = tir.Tyre.from_values({})
    steady, lagging = (Interface.of(tyre, transient=transient) for transient in (False, True))
    assert {x.name: x.description for x in steady.inputs}["kappa"].startswith("longitudinal slip")
    assert {x.name: x.description for x in lagging.outputs}["kappa"] == "lagging longitudinal slip"
    assert {x.name: x.description for x in steady.outputs}["Fz_out"] == "load in the formulae"
    for interface in (steady, lagging):
        references = [x.reference for part in interface for x in part]
        assert references == [*range(1, len(references) + 1)]


@pytest.fixture(scope="module")
def fmus(tmp_path_factory) -> dict[int, Path]:
    """An FMU of each version; the file's name is one that XML and C have to be careful with."""
    folder = tmp_path_factory.mktemp("fmu")
    file = folder / '1 front & "rear" <x>.tir'
    file.write_bytes(FILE.read_bytes())
    name = "tyre_1_front____rear___x_"
    return {fmi: write_fmu(file, folder / str(fmi), fmi=fmi, name=name, turn_slip=True) for fmi in (2, 3)}


@pytest.fixture(scope="module")
def fmu_of(tmp_path_factory) -> Callable[[int, bool], Path]:
    """The FMU of the file as it is, by version and by whether its contact lags; each is compiled once."""
    folder = tmp_path_factory.mktemp("plain")
    return cache(lambda fmi, lags: write_fmu(FILE, folder / f"{fmi} {lags}", fmi=fmi, transient=lags))


def conditions(n: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(5)
    columns = {
        "Fz": (-50.0, 4000.0), "kappa": (-0.9, 0.9), "alpha": (-0.3, 0.3), "gamma": (-0.8, 0.8), "phi_t": (-0.7, 0.7),
        "Vx": (-30.0, 30.0), "p": (1.5e5, 3.5e5),
    }  # fmt: skip
    return {name: rng.uniform(*ends, n) for name, ends in columns.items()}


def wanted(given: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Results of ``tir`` for the same condition, by the FMU's names."""
    tyre = tir.read(FILE)
    forces = tyre(**given, turn_slip=True)
    state = tyre.state(**given, turn_slip=True)._asdict()
    names = [x.name for x in OUTPUTS]
    return dict(zip(FORCES, forces, strict=True)) | {name: state[name] for name in names if name in state}


def assert_equal(found: np.ndarray, right: np.ndarray, name: str) -> None:
    scale = np.maximum(np.abs(right), 1e-3 * np.max(np.abs(right)))
    assert np.max(np.abs(found - right) / scale) < 1e-12, name


@needs_compiler
@pytest.mark.parametrize("fmi", [2, 3])
def test_fmpy_accepts_the_fmu(fmus, fmi):
    pytest.importorskip("fmpy")
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(fmus[fmi])) == []


@needs_compiler
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_simulation_gives_the_forces_of_tir(fmus, fmi, kind):
    fmpy = pytest.importorskip("fmpy")
    n = 40
    given = conditions(n)
    time = np.arange(n) * 0.01
    signals = np.zeros(n, dtype=[("time", float), *((name, float) for name in INPUTS)])
    signals["time"] = time
    for name in INPUTS:
        signals[name] = given[name]
    found = fmpy.simulate_fmu(
        str(fmus[fmi]), fmi_type=kind, input=signals, stop_time=time[-1], output_interval=0.01, step_size=0.01,
        output=[*INPUTS, *(x.name for x in OUTPUTS)],
    )  # fmt: skip
    recorded = {name: found[name] for name in INPUTS}
    assert np.ptp(recorded["Fz"]) > 3000.0
    for name, right in wanted(recorded).items():
        assert_equal(found[name], right, name)


@needs_compiler
@pytest.mark.parametrize("fmi", [2, 3])
def test_scaling_factors_and_temperature_can_be_turned(tmp_path, fmi):
    """Against a tyre with these factors, taken to this temperature or the nearest tested one; p starts as that of the file."""
    fmpy = pytest.importorskip("fmpy")
    terms = {"rig.k_T_grip_per_K": (-0.005, 1e-4, "1/K"), "rig.T_ref_degC": (60.0, 0.0, "degC")}
    terms |= {"T_min_degC": (45.0, 0.0, "degC"), "T_max_degC": (80.0, 0.0, "degC")}
    tyre = tir.read(FILE).annotate(measured={name: tir.Quantity(*x) for name, x in terms.items()})
    tyre.replace(LMUY=0.9).write(tmp_path / "front.tir")
    fmu = write_fmu(tmp_path / "front.tir", tmp_path, fmi=fmi)
    turned = {"LMUY": 0.7, "LKY": 1.2, "LKYC": 0.8, "LTR": 1.1, "LMUX": 0.95, "LKX": 1.3}
    at = {"Fz": 1400.0, "alpha": 0.06, "gamma": 0.3, "kappa": 0.03, "p": 2.2e5}
    for factors, T in (
        ({}, 60.0),
        ({**turned, "T_degC": 75.0}, 75.0),
        ({"T_degC": -20.0}, 45.0),
        ({"T_degC": 95.0}, 80.0),
    ):
        found = fmpy.simulate_fmu(
            str(fmu), start_values={**at, **factors}, stop_time=0.01, output=["Fx", "Fy", "Mz", "K_ya"]
        )
        scaled = tyre.replace(LMUY=0.9).replace(**{k: v for k, v in factors.items() if k != "T_degC"})
        warm = scaled.at_temperature(T)
        for name in ("Fx", "Fy", "Mz"):
            assert found[name][-1] == pytest.approx(getattr(warm(**at), name), rel=1e-10)
        assert found["K_ya"][-1] == pytest.approx(warm.state(**at).K_ya, rel=1e-10)


@needs_compiler
@pytest.mark.parametrize("fmi", [2, 3])
def test_the_lag_of_the_contact_is_that_of_tir(fmu_of, tmp_path, fmi):
    """A steering and braking manoeuvre that ends in standstill, in steps of 10 ms."""
    fmpy = pytest.importorskip("fmpy")
    from fmpy.validation import validate_fmu

    fmu = fmu_of(fmi, True)
    assert validate_fmu(str(fmu)) == []
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(tmp_path)
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-c"]
    sources = map(str, sorted((tmp_path / "sources").glob("*.c")))
    subprocess.run([str(COMPILER), *strict, *sources], cwd=tmp_path, check=True)
    n, dt = 80, 0.01
    signals = np.zeros(
        n, dtype=[(name, float) for name in ("time", "Fz", "Vx", "Vsx", "Vsy", "gamma", "damping")]
    )
    signals["time"] = dt * np.arange(n)
    signals["Fz"], signals["damping"] = 1400.0, 300.0
    signals["Vx"] = np.maximum(6.0 - 10.0 * signals["time"], 0.0)
    signals["Vsx"], signals["Vsy"] = 0.2 * np.sin(9.0 * signals["time"]), 0.3 * np.cos(7.0 * signals["time"])
    signals["gamma"] = 0.2 * signals["time"]
    found = fmpy.simulate_fmu(
        str(fmu), fmi_type="CoSimulation", input=signals, stop_time=signals["time"][-1], output_interval=dt, step_size=dt,
        output=["Fx", "Fy", "Mz", "u", "v", "alpha"],
    )  # fmt: skip
    tyre, contact = tir.read(FILE), Contact()
    for i, row in enumerate(signals[:-1]):
        _, Fz, Vx, Vsx, Vsy, gamma, damping = (float(x) for x in row)
        contact, _ = step(tyre, contact, dt, Fz, Vx, Vsx, Vsy, gamma, damping=damping)
        if i >= 1:
            assert (found["u"][i + 1], found["v"][i + 1]) == pytest.approx(contact, rel=1e-6, abs=1e-9)
    at_end = signals[-1]
    assert abs(found["v"][-1]) > 1e-3
    end = transient.forces(
        tyre, contact, 1400.0, *(float(at_end[x]) for x in ("Vx", "Vsx", "Vsy", "gamma")), damping=300.0
    )
    for name in ("Fx", "Fy", "Mz"):
        assert found[name][-1] == pytest.approx(getattr(end, name), rel=0.02, abs=1.0)


@needs_compiler
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("transient", [False, True])
@pytest.mark.parametrize(
    ("start", "said"),
    [
        ({"LFZO": 0.0}, "p = 250000.*LFZO = 0$"),
        ({"p": float("nan")}, "p = nan"),
        ({"Fz": float("inf")}, "Fz = inf"),
    ],
)
def test_a_result_that_is_no_number_has_a_status_and_a_sentence(fmu_of, fmi, transient, start, said):
    """A force over a nominal load of zero, 4.E2a, is no number, and a simulation must not go on with it."""
    fmpy = pytest.importorskip("fmpy")
    fmu, logged = fmu_of(fmi, transient), []
    run = partial(
        fmpy.simulate_fmu, str(fmu), fmi_type="CoSimulation", stop_time=0.02, output_interval=0.01, output=["Fx", "Fy"],
        logger=lambda *given: logged.append(given[-1].decode()),
    )  # fmt: skip
    with pytest.raises(Exception, match=r"failed with status 2 \(discard\)"):
        run(start_values=start)
    assert re.match(rf"Fx is not a finite number: correct the property file, or one of .*{said}", logged[0])
    logged.clear()
    assert np.all(np.isfinite(run(start_values={"LFZO": 1.1})["Fy"]))
    assert not logged


@needs_compiler
@pytest.mark.parametrize("fmi", [2, 3])
def test_a_step_that_gives_no_number_is_refused_and_leaves_the_contact(fmu_of, tmp_path, fmi):
    fmpy = pytest.importorskip("fmpy")
    fmu, logged = fmu_of(fmi, True), []
    description = fmpy.read_model_description(str(fmu))
    reference = {x.name: x.valueReference for x in description.modelVariables}
    instance = fmpy.instantiate_fmu(
        fmpy.extract(str(fmu), str(tmp_path / "x")), description, "CoSimulation",
        logger=lambda *given: logged.append(given[-1].decode()),
    )  # fmt: skip
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    get = instance.getReal if fmi == 2 else instance.getFloat64
    set_ = instance.setReal if fmi == 2 else instance.setFloat64
    set_([reference["Vsy"]], [0.5])
    instance.doStep(0.0, 0.01)
    (before,) = get([reference["v"]])
    assert before > 1e-4
    set_([reference["Vsy"]], [float("nan")])
    with pytest.raises(Exception, match=r"failed with status 3 \(error\)"):
        instance.doStep(0.01, 0.01)
    assert "the deflection of the contact is not a finite number" in logged[0]
    assert "Vsy = nan" in logged[0]
    set_([reference["Vsy"]], [0.5])
    assert get([reference["v"], 0]) == [before, 0.01]
    instance.freeInstance()


@needs_compiler
@pytest.mark.parametrize("fmi", [2, 3])
def test_co_simulation_is_one_step_behind_its_inputs_and_says_so(fmus, fmi):
    """A master that sets, steps and reads, as FMPy, gets at the end of a step the force of the inputs at its begin."""
    fmpy = pytest.importorskip("fmpy")
    n, dt = 20, 0.01
    signals = np.zeros(n, dtype=[("time", float), ("alpha", float)])
    signals["time"], signals["alpha"] = dt * np.arange(n), np.linspace(0.0, 0.1, n)
    found = fmpy.simulate_fmu(
        str(fmus[fmi]), fmi_type="CoSimulation", input=signals, stop_time=signals["time"][-1], output_interval=dt,
        step_size=dt, output=["Fy"],
    )  # fmt: skip
    tyre = tir.read(FILE)
    wanted = tyre(tyre["FNOMIN"], signals["alpha"], turn_slip=True).Fy
    np.testing.assert_allclose(found["Fy"][1:], wanted[:-1], rtol=1e-9)
    with zipfile.ZipFile(fmus[fmi]) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    assert "one communication step behind" in root.attrib["description"]


@needs_compiler
@pytest.mark.parametrize("fmi", [2, 3])
def test_units_and_starts_are_declared(fmus, fmi):
    """Base units by hand: a moment is kg m2/s2; the start is the nominal condition of the file."""
    with zipfile.ZipFile(fmus[fmi]) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    assert root.attrib["modelName"] == '1 front & "rear" <x>, turn slip on'
    units = {unit.attrib["name"]: dict(unit.find("BaseUnit").attrib) for unit in root.iter("Unit")}
    assert units["Nm"] == {"kg": "1", "m": "2", "s": "-2"}
    tyre = tir.read(FILE)
    real = [x for x in root.iter() if "name" in x.attrib and x.attrib.get("causality") in ("input", "output")]
    starts, named = {}, {}
    for x in real:
        inner = x.find("Real") if fmi == 2 else x
        named[x.attrib["name"]] = inner.attrib.get("unit", "")
        if x.attrib["causality"] == "input":
            starts[x.attrib["name"]] = float(inner.attrib["start"])
    assert set(named) == {*INPUTS, *(x.name for x in OUTPUTS)}
    assert {unit for unit in named.values() if unit} <= set(UNITS) & set(units)
    assert (named["K_ya"], named["sigma_y"], named["kappa"]) == ("N/rad", "m", "")
    assert starts == {
        "Fz": tyre["FNOMIN"], "kappa": 0, "alpha": 0, "gamma": 0, "phi_t": 0, "Vx": tyre["LONGVL"], "p": tyre["INFLPRES"]
    }  # fmt: skip


@pytest.mark.parametrize("transient", [False, True])
@pytest.mark.parametrize("fmi", [2, 3])
def test_every_unit_is_the_product_of_si_units_that_its_name_says(tmp_path, fmi, transient):
    """Of a file with terms of temperature too, whose zero is that of degC."""
    registry = pint.UnitRegistry()
    symbols = {"kilogram": "kg", "meter": "m", "second": "s", "radian": "rad", "kelvin": "K"}
    terms = {"rig.k_T_grip_per_K": (-0.005, 1e-4, "1/K"), "rig.T_ref_degC": (60.0, 0.0, "degC")}
    terms |= {"T_min_degC": (45.0, 0.0, "degC"), "T_max_degC": (80.0, 0.0, "degC")}
    warm = tmp_path / "warm.tir"
    measured = {name: tir.Quantity(*value) for name, value in terms.items()}
    tir.read(FILE).annotate(measured=measured).write(warm)
    with zipfile.ZipFile(
        write_fmu(warm, tmp_path / "fmu", fmi=fmi, sources_only=True, transient=transient)
    ) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    units = {unit.attrib["name"]: unit for unit in root.iter("Unit")}
    assert {"degC", *(["Ns/m"] if transient else [])} <= set(units)
    for name, unit in units.items():
        zero, one = (
            registry.Quantity(x, name.replace("Nm", "N m").replace("Ns", "N s")).to_base_units()
            for x in (0.0, 1.0)
        )
        assert one.magnitude - zero.magnitude == pytest.approx(1.0)
        powers = {symbols[str(name)]: f"{power:g}" for name, power in one.unit_items()}
        declared = dict(unit.find("BaseUnit").attrib)
        assert float(declared.pop("offset", 0.0)) == zero.magnitude, name
        assert declared == powers, name
        shown = unit.find("DisplayUnit")
        if shown is not None:
            named = registry.Quantity(1.0, name).to(shown.attrib["name"])
            assert float(shown.attrib["factor"]) == pytest.approx(named.magnitude)
    assert {name for name, unit in units.items() if unit.find("DisplayUnit") is not None} == {"Pa", "rad"}


@pytest.mark.parametrize("fmi", [2, 3])
def test_version_3_says_how_its_sources_are_built(tmp_path, fmi):
    """FMI 3.0 lists sources in a file of their own, FMI 2.0 in the model description."""
    with zipfile.ZipFile(write_fmu(FILE, tmp_path, fmi=fmi, sources_only=True)) as archive:
        build = [name for name in archive.namelist() if "buildDescription" in name]
        place = build[0] if build else "modelDescription.xml"
        root = ElementTree.fromstring(archive.read(place))
        listed = {x.attrib["name"] for x in root.iter("SourceFile" if build else "File")}
        assert {f"sources/{name}" for name in listed} <= set(archive.namelist())
    assert build == (["sources/buildDescription.xml"] if fmi == 3 else [])
    assert listed == {"moto_front.c", f"moto_front_fmi{fmi}.c"}


class ByHand:
    """FMI 2.0's functions called as its document has them, without a library."""

    def __init__(self, fmu: Path, folder: Path):
        with zipfile.ZipFile(fmu) as archive:
            (place,) = [name for name in archive.namelist() if name.startswith("binaries/")]
            library = folder / "by_hand.so"
            library.write_bytes(archive.read(place))
            self.guid = ElementTree.fromstring(archive.read("modelDescription.xml")).attrib["guid"]
        self.library = ctypes.CDLL(str(library))
        self.library.fmi2Instantiate.restype = c_void_p
        self.library.fmi2Instantiate.argtypes = [c_char_p, c_int, c_char_p, c_char_p, c_void_p, c_int, c_int]
        for name in ("fmi2GetReal", "fmi2SetReal"):
            getattr(self.library, name).argtypes = [c_void_p, POINTER(c_uint), c_size_t, POINTER(c_double)]
        for name in (
            "fmi2GetFMUstate",
            "fmi2SetFMUstate",
            "fmi2FreeFMUstate",
            "fmi2Reset",
            "fmi2FreeInstance",
        ):
            getattr(self.library, name).argtypes = [c_void_p] * (2 if "state" in name else 1)

    def instance(self, guid: str | None = None) -> int | None:
        return self.library.fmi2Instantiate(b"a", 1, (guid or self.guid).encode(), None, None, 0, 0)

    def get(self, m, *references) -> list[float]:
        out = (c_double * len(references))()
        assert self.library.fmi2GetReal(m, (c_uint * len(references))(*references), len(references), out) == 0
        return list(out)

    def set(self, m, **values) -> int:
        names = [INPUTS.index(name) + 1 for name in values]
        return self.library.fmi2SetReal(
            m, (c_uint * len(names))(*names), len(names), (c_double * len(names))(*values.values())
        )


@needs_compiler
@pytest.mark.skipif(sys.platform == "win32", reason="a loaded library cannot be removed there")
def test_instances_are_independent_and_states_come_back(fmus, tmp_path):
    hand, tyre = ByHand(fmus[2], tmp_path), tir.read(FILE)
    assert hand.instance("{00000000-0000-0000-0000-000000000000}") is None
    a, b = hand.instance(), hand.instance()
    Fy = next(x.reference for x in OUTPUTS if x.name == "Fy")
    assert hand.set(a, Fz=1200.0, alpha=0.05) == 0
    (here,), (there,) = hand.get(a, Fy), hand.get(b, Fy)
    assert here == pytest.approx(tyre(1200.0, 0.05, phi_t=0.0).Fy, rel=1e-12)
    assert there == pytest.approx(tyre(tyre["FNOMIN"], phi_t=0.0).Fy, rel=1e-12)
    kept = c_void_p()
    assert hand.library.fmi2GetFMUstate(a, byref(kept)) == 0
    hand.set(a, alpha=-0.1)
    assert hand.get(a, Fy)[0] > 0.0
    assert hand.library.fmi2SetFMUstate(a, kept) == 0
    assert hand.get(a, Fy) == [here]
    hand.library.fmi2FreeFMUstate(a, byref(kept))
    assert hand.library.fmi2Reset(a) == 0
    assert hand.get(a, Fy) == [there]
    assert hand.set(a, alpha=float("nan")) == 0
    output, value = (c_uint * 1)(Fy), (c_double * 1)()
    assert hand.library.fmi2GetReal(a, output, 1, value) == 2, "outside the range of the equations: discard"
    assert np.isnan(value[0])
    assert np.isnan(hand.get(a, 1 + INPUTS.index("alpha"))[0]), "what was set can be read"
    assert hand.set(a, alpha=-0.1) == 0
    assert hand.get(a, Fy)[0] > 0.0
    assert hand.library.fmi2SetReal(a, output, 1, (c_double * 1)(1.0)) == 3, "an output cannot be set"
    assert hand.library.fmi2GetReal(a, (c_uint * 1)(99), 1, (c_double * 1)()) == 3
    step = hand.library.fmi2DoStep
    step.argtypes = [c_void_p, c_double, c_double, c_int]
    assert [step(a, 1.0, dt, 0) for dt in (0.1, 0.0, -0.1, float("nan"))] == [0, 0, 3, 3]
    assert hand.get(a, 0) == [1.0], "a refused step leaves the time"
    for m in (a, b):
        hand.library.fmi2FreeInstance(m)


@needs_compiler
@pytest.mark.parametrize("fmi", [2, 3])
def test_the_sources_compile_without_a_warning_with_prefixed_names(fmus, fmi, tmp_path):
    with zipfile.ZipFile(fmus[fmi]) as archive:
        archive.extractall(tmp_path)
    sources = sorted((tmp_path / "sources").glob("*.c"))
    assert len(sources) == 2
    warnings = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror"]
    prefix = ["-DFMI2_FUNCTION_PREFIX=tyre_1_front____rear___x__"] if fmi == 2 else []
    command = [str(COMPILER), *warnings, *prefix, "-c", *map(str, sources)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    symbols = (tmp_path / f"{sources[1].stem}.o").read_bytes()
    assert f"tyre_1_front____rear___x__fmi{fmi}DoStep".encode() in symbols


def test_the_same_tyre_gives_the_same_bytes(tmp_path):
    one = write_fmu(FILE, tmp_path / "a", sources_only=True)
    two = write_fmu(FILE, tmp_path / "b", sources_only=True)
    assert one.read_bytes() == two.read_bytes()
    with zipfile.ZipFile(one) as archive:
        assert not [name for name in archive.namelist() if name.startswith("binaries")]
        assert {info.external_attr >> 16 & 0o444 for info in archive.infolist()} == {0o444}


def test_without_a_compiler_the_message_names_the_remedy(tmp_path, monkeypatch):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match=r"no C compiler.*--sources-only"):
        write_fmu(FILE, tmp_path / "out")
    assert not (tmp_path / "out").exists()
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(InputError, match="no-such-compiler did not run"):
        write_fmu(FILE, tmp_path / "out")
    assert write_fmu(FILE, tmp_path / "out", sources_only=True).is_file()


@pytest.mark.skipif(sys.platform == "win32", reason="a script is no program there")
@pytest.mark.parametrize(
    ("printed", "reason"),
    [("in file x.c\nx.c:1: error: boom\nmore", "x.c:1: error: boom"), ("no licence", "no licence")],
)
def test_a_compiler_that_fails_is_quoted(tmp_path, monkeypatch, printed, reason):
    script = tmp_path / "cc"
    script.write_text(f"#!/bin/sh\ncat >&2 <<END\n{printed}\nEND\nexit 1\n")
    script.chmod(0o755)
    monkeypatch.setenv("CC", str(script))
    with pytest.raises(InputError) as caught:
        write_fmu(FILE, tmp_path / "out")
    assert f"the C compiler {script} failed ({reason}); name another one in CC" in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_files_of_others_are_left_alone(tmp_path):
    (tmp_path / "moto_front.h").write_text("mine")
    with pytest.raises(InputError, match=r"moto_front\.h.*no run of mffit"):
        write_c(FILE, tmp_path)
    assert (tmp_path / "moto_front.h").read_text() == "mine"
    assert not (tmp_path / "moto_front.c").exists()


def test_the_commands_write_where_they_are_told(tmp_path, capsys):
    main(["export", "c", str(FILE), "--out", str(tmp_path), "--name", "front", "--no-turn-slip"])
    main(["export", "fmu", str(FILE), "--out", str(tmp_path), "--sources-only", "--fmi", "3"])
    assert {"front.c", "front.h", "moto_front.fmu"} <= {path.name for path in tmp_path.iterdir()}
    assert "turn slip off" in (tmp_path / "front.h").read_text()
    assert "moto_front.fmu" in capsys.readouterr().out


def test_the_switches_reach_the_code(tmp_path):
    held = write_fmu(FILE, tmp_path, turn_slip=False, limits=True, sources_only=True)
    with zipfile.ZipFile(held) as archive:
        assert "inputs held to the file's ranges;" in archive.read("sources/moto_front.h").decode()
        assert "turn slip off, inputs held" in archive.read("modelDescription.xml").decode()
    main(["export", "c", str(FILE), "--out", str(tmp_path / "c"), "--transient"])
    assert "moto_front_step(" in (tmp_path / "c" / "moto_front.h").read_text()
    main(["export", "c", str(FILE), "--out", str(tmp_path / "c")])
    assert "moto_front_step(" not in (tmp_path / "c" / "moto_front.h").read_text()


@pytest.mark.parametrize(
    ("mode", "option", "name", "on"),
    [
        (124, [], "front", False),
        (225, [], "front", True),
        (124, ["--turn-slip"], "front_turn_slip", True),
        (225, ["--no-turn-slip"], "front_normal", False),
    ],
)
@pytest.mark.parametrize("kind", ["c", "fmu"])
def test_the_mode_is_the_files_unless_asked_for_and_is_told(tmp_path, capsys, kind, mode, option, name, on):
    tir.read(FILE).replace(USE_MODE=mode).write(tmp_path / "front.tir")
    sources = ["--sources-only"] if kind == "fmu" else []
    main(["export", kind, str(tmp_path / "front.tir"), "--out", str(tmp_path / "out"), *option, *sources])
    words = f"turn slip {'on' if on else 'off'}"
    assert words in capsys.readouterr().out
    if kind == "c":
        assert f"With {words}; the file has" in (tmp_path / "out" / f"{name}.h").read_text()
        return
    with zipfile.ZipFile(tmp_path / "out" / f"{name}.fmu") as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    assert root.attrib["modelName"] == f"front, {words}"
    assert words in root.attrib["description"]


def test_turn_slip_without_measured_coefficients_is_warned_of(tmp_path, capsys):
    tyre = tir.read(FILE.parent / "MagicFormula62.tir")
    tyre.replace(USE_MODE=125).write(tmp_path / "guessed.tir")
    tyre.replace(USE_MODE=125, PHYP2=0.0).write(tmp_path / "zero.tir")
    for file, said in (("guessed", "common defaults"), ("zero", "no side force")):
        for option in ([], ["--no-turn-slip"]):
            main(["export", "c", str(tmp_path / f"{file}.tir"), "--out", str(tmp_path / "out"), *option])
            assert (said in capsys.readouterr().err) is (not option)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--name", "3x"], "not a valid name in C"),
        (["--fmi", "1"], "Invalid value"),
        (["--out", "there/front.fmu"], "write --out there --name front"),
    ],
)
def test_bad_choices_end_in_one_sentence(tmp_path, capsys, arguments, said):
    with pytest.raises(SystemExit) as end:
        main(["export", "fmu", str(FILE), "--out", str(tmp_path), *arguments])
    assert end.value.code == 2
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@needs_compiler
@pytest.mark.parametrize("stem", ["math", "int", "front"])
def test_a_file_name_may_be_a_word_of_c(tmp_path, stem):
    shutil.copyfile(FILE, tmp_path / f"{stem}.tir")
    header, source = write_c(tmp_path / f"{stem}.tir", tmp_path / "out")
    name = stem if stem == "front" else f"tyre_{stem}"
    assert (header.name, source.name) == (f"{name}.h", f"{name}.c")
    command = [str(COMPILER), "-std=c99", "-Wall", "-Werror", "-fsyntax-only", "-I.", source.name]
    subprocess.run(command, cwd=tmp_path / "out", check=True)
