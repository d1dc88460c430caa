"""The classical reduction of a split-Hopkinson test, from the gauges in the result file alone."""

import json

import h5py
import numpy as np
import pytest

SCENE = "runs/split-hopkinson.toml"
FRONTS = ("--set", "solve.method=moc", "--set", "solve.cells=")


def pulses(file, moments, striker, incident, specimen):
    """Incident, reflected and transmitted stress (Pa), each at the time at which it is at the specimen."""
    speed = np.sqrt(incident["material"]["modulus"] / incident["material"]["density"])
    face = striker["length"] + incident["length"]
    start = incident["length"] / speed

    def at(name, delay):
        gauge = file["gauges"][name]
        return np.interp(start + moments + delay, gauge["time"][:], gauge["stress"][:])

    before = (face - file["gauges"]["incident"].attrs["x"]) / speed
    after = (file["gauges"]["transmitted"].attrs["x"] - face - specimen["length"]) / speed
    return at("incident", -before), at("incident", before), at("transmitted", after)


@pytest.mark.parametrize("arguments", [(), FRONTS], ids=["fd", "moc"])
def test_the_reduction_gives_back_the_specimen_s_curve(run, arguments):
    with h5py.File(run(SCENE, *arguments)) as file:
        striker, incident, specimen, _ = json.loads(file.attrs["scene_resolved"])["bar"]["segment"]
        moments = np.linspace(0, 150e-6, 4001)
        into, back, through = pulses(file, moments, striker, incident, specimen)
    impedance = np.sqrt(incident["material"]["modulus"] * incident["material"]["density"])
    rate = (back - into + through) / (impedance * specimen["length"])
    strain = np.concatenate([[0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(moments))])
    stress = -0.5 * (into + back + through) * incident["area"] / specimen["area"]
    curve = specimen["material"]["compression"]
    put_in = np.interp(strain, curve["strain"], curve["stress"])
    # Once the sudden pulse has gone some times through the specimen.
    settled = moments > 40e-6
    assert strain[-1] > 0.2
    assert np.abs(stress[settled] / put_in[settled] - 1).max() < 0.03
