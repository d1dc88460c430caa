"""The tables of a sweep, read as users read them."""

import csv
import subprocess
import sys

import h5py
import pytest
import xarray

from conftest import ROOT

SWEEP = """
[sweep]
scene = "scene.toml"
metrics = ["left.stress_Pa", "above_critical"]

[axes]
"left.value" = { from = "-10 m/s", to = "-110 m/s", count = 3 }
"bar.material" = ["copper-annealed", "mild-steel"]
"""

SCENE = """
[bar]
length = 1
area = 1e-4
material = "copper-annealed"
[left]
kind = "velocity"
value = -30
[right]
kind = "free"
[solve]
until = "100 us"
method = "moc"
"""


def test_axes_are_coordinates(program, tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "sweep.toml").write_text(SWEEP)
    subprocess.run([program, "sweep", tmp_path / "sweep.toml", "-o", tmp_path / "out", "--quiet"], check=True)
    data = xarray.open_dataset(tmp_path / "out/sweep.h5", engine="h5netcdf")
    assert dict(data.sizes) == {"left.value": 3, "bar.material": 2}
    assert data["left.value"].values.tolist() == [-10, -60, -110]
    assert data["left.value"].units == "m/s" and data["left.stress_Pa"].units == "Pa"
    copper = data.sel({"bar.material": "copper-annealed"})
    assert copper["above_critical"].values.tolist() == [0, 0, 1]
    assert copper["status"].values.tolist() == ["done", "done", "rupture"]
    with open(tmp_path / "out/table.csv") as table:
        rows = list(csv.DictReader(line for line in table if not line.startswith("#")))
    assert [float(row["left.stress_Pa"]) for row in rows] == data["left.stress_Pa"].values.ravel().tolist()


def test_cases_are_the_dimension_where_there_is_no_product(program, tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    text = SWEEP.replace("metrics", 'combine = "zip"\nmetrics').replace(', "mild-steel"', ', "mild-steel", "copper-annealed"')
    (tmp_path / "sweep.toml").write_text(text)
    subprocess.run([program, "sweep", tmp_path / "sweep.toml", "-o", tmp_path / "out", "--quiet"], check=True)
    with h5py.File(tmp_path / "out/sweep.h5") as file:
        assert file["left.stress_Pa"].shape == (3,)
        assert file["left.stress_Pa"].dims[0][0].name == "/case"
        assert [name.decode() for name in file["bar.material"]] == ["copper-annealed", "mild-steel", "copper-annealed"]


def test_the_shards_of_dask_give_the_table_of_one_sweep(program, tmp_path):
    pytest.importorskip("distributed", reason="Dask is not installed")
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "sweep.toml").write_text(SWEEP)
    subprocess.run([program, "sweep", "sweep.toml", "-o", "one", "--quiet"], cwd=tmp_path, check=True)
    script = ROOT / "examples/sweeps/dask_sweep.py"
    command = [sys.executable, script, "sweep.toml", "shards", "--shards", "3", "--program", program]
    printed = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    assert "(3 of 3)" in printed and (tmp_path / "shards/shard-3-of-3").is_dir()
    assert (tmp_path / "shards.csv").read_bytes() == (tmp_path / "one/table.csv").read_bytes()
