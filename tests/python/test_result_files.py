"""Result files as h5py and xarray see them."""

import json
import pathlib
import re
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
import xarray

# A reader that has to warn about the file is a defect of the file.
pytestmark = pytest.mark.filterwarnings("error")

ROOT = pathlib.Path(__file__).resolve().parents[2]
BILINEAR = "runs/bilinear-p2.toml"
COPPER = "runs/copper-below-critical.toml"
ABOVE = "runs/copper-above-critical.toml"
PULSE = "runs/pulse-tension-us.toml"
LEDGER = {"time", "kinetic", "elastic", "plastic", "work_left", "work_right", "momentum", "impulse", "residual"}


def open_xarray(path, group=None):
    with xarray.open_dataset(path, engine="h5netcdf", group=group) as dataset:
        return dataset.load()


def test_root_attributes_tell_where_the_file_comes_from(run):
    with h5py.File(run(BILINEAR)) as file:
        attributes = dict(file.attrs)
    assert attributes["format"] == "barwave"
    assert attributes["format_version"] == 2
    assert re.fullmatch(r"\d+\.\d+\.\d+.*", attributes["program_version"])
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", attributes["created"])
    assert attributes["Conventions"] == "CF-1.11"
    assert attributes["wall_seconds_units"] == "s"
    assert attributes["title"] == "Bilinear bar struck at 20 m/s"
    assert attributes["scene"] == (ROOT / BILINEAR).read_text()
    assert isinstance(json.loads(attributes["scene_resolved"]), dict)
    assert any(effect.startswith("hardening") for effect in attributes["effects"])
    assert attributes["method"] == "fd"
    assert attributes["outcome"] == "done"
    assert attributes["wall_seconds"] > 0
    assert attributes["cell_steps"] > 0


def test_critical_velocity_is_there_where_the_curve_has_one(run):
    with h5py.File(run(COPPER)) as file:
        assert 30 < file.attrs["critical_velocity"] < 1000
    # The bilinear curve rises for ever.
    with h5py.File(run(BILINEAR)) as file:
        assert "critical_velocity" not in file.attrs


def test_fields_have_labelled_axes_in_xarray(run):
    dataset = open_xarray(run(BILINEAR))
    for name, units in {"stress": "Pa", "strain": "1", "velocity": "m/s"}.items():
        field = dataset[name]
        assert field.dims == ("time", "x")
        assert field.dtype == np.float64
        assert field.attrs["units"] == units
        assert field.attrs["long_name"]
        assert np.isfinite(field).all()
    assert dataset.sizes["time"] == 81
    assert dataset.sizes["x"] == 1000
    assert dataset.time.attrs["units"] == "s"
    assert dataset.x.attrs["units"] == "m"
    assert dataset.time[0] == 0
    # The last frame is the end time of the scene, exactly as it is written there.
    assert float(dataset.time[-1]) == pytest.approx(157.98734e-6, rel=1e-12)
    assert (np.diff(dataset.time) > 0).all()
    # Labels work: the plateau behind both fronts, 386.554 MPa in compression (six digits are known).
    plateau = dataset.stress.sel(time=150e-6, x=0.05, method="nearest")
    assert float(plateau) == pytest.approx(-386.554e6, rel=1e-3)


def test_fields_have_labelled_axes_in_h5py(run):
    with h5py.File(run(BILINEAR)) as file:
        stress = file["stress"]
        assert file["time"].is_scale and file["x"].is_scale
        assert stress.dims[0][0] == file["time"]
        assert stress.dims[1]["x"] == file["x"]
        assert stress.maxshape == (None, 1000)
        assert stress.chunks == (1, 1000)
        assert stress.compression == "gzip" and stress.compression_opts == 1 and stress.shuffle
        assert file["time"].maxshape == (None,)


def test_only_what_was_asked_for_is_written(run):
    with h5py.File(run(PULSE)) as file:
        assert {"stress", "velocity", "plastic_strain"} <= set(file)
        assert not {"strain", "displacement", "temperature"} & set(file)
        assert {file[name].dtype for name in ("stress", "velocity", "plastic_strain")} == {np.dtype("float32")}
        assert file["time"].dtype == file["x"].dtype == np.float64
        assert file["time"][:] == pytest.approx([0, 1e-4, 2e-4, 3e-4, 4e-4, 5e-4])
        assert set(file["gauges"]) == {"6 in", "12 in", "50 in"}
        assert file["gauges/6 in"].attrs["x"] == pytest.approx(6 * 0.0254)


def test_gauges_open_as_histories(run):
    path = run(COPPER)
    middle = open_xarray(path, "gauges/middle")
    assert set(middle.variables) == {"time", "stress", "strain", "velocity"}
    assert middle.stress.dims == middle.time.dims == ("sample",)
    assert middle.stress.attrs["units"] == "Pa"
    assert middle.attrs["x"] == 0.5
    assert (np.diff(middle.time) > 0).all()
    # No time comes twice: times can be labels.
    assert float(middle.swap_dims(sample="time").stress.sel(time=0, method="nearest")) == 0
    # A full-rate history has more rows than there are frames.
    assert middle.sizes["sample"] > open_xarray(path).sizes["time"]


@pytest.mark.parametrize("side", ["left", "right"])
def test_ends_open_as_histories(run, side):
    end = open_xarray(run(BILINEAR), f"ends/{side}")
    assert set(end.variables) - {"force"} == {"time", "stress", "velocity"}
    assert end.stress.dims == ("sample",)
    assert end.sizes["sample"] > 81
    assert (np.diff(end.time) >= 0).all()


def test_fronts_are_one_table_with_theory_and_measurement(run):
    fronts = open_xarray(run(BILINEAR), "fronts").to_dataframe().to_records()
    wanted = "strain_behind strain_ahead stress_behind stress_ahead speed speed_measured position".split()
    assert set(wanted) <= set(fronts.dtype.names)
    # Texts are texts, whatever their length.
    assert list(fronts["origin"]) == ["left"] * 2
    assert len(fronts) == 2
    # c0 = sqrt(E/rho) and sqrt(E_t/rho), from the scene's own numbers: equal to round-off.
    assert fronts["speed"] == pytest.approx(np.sqrt([200e9 / 7800, 20e9 / 7800]), rel=1e-9)
    # Measured in a field of 1000 cells: a front is spread over a few of them.
    assert fronts["speed_measured"] == pytest.approx(fronts["speed"], rel=0.02)
    assert fronts["stress_behind"][1] == pytest.approx(-386.554e6, rel=1e-5)
    fronts = open_xarray(run(COPPER), "fronts")
    assert {"arrival_near", "arrival_middle"} <= set(fronts)
    assert {fronts[name].attrs["units"] for name in ("speed", "arrival_near", "stress_ahead")} == {"m/s", "s", "Pa"}
    # The fastest front passes the nearer gauge first.
    assert 0 < fronts["arrival_near"][0] < fronts["arrival_middle"][0]


@pytest.mark.parametrize("scene", [BILINEAR, "runs/bilinear-p2-moc.toml", "runs/torsion-rod.toml", "runs/beam.toml"])
def test_the_whole_file_opens_as_a_tree(run, scene):
    with xarray.open_datatree(run(scene), engine="h5netcdf") as tree:
        tree.load()
    for node in tree.subtree:
        for column in node.data_vars.values():
            # Columns can be indexed: no dimension of theirs is taken for one of the fields.
            assert column[{dim: -1 for dim in column.dims if column.sizes[dim]}].ndim <= column.ndim
        for name, column in node.data_vars.items():
            assert column.dtype.kind in "OUT" or "units" in column.attrs, f"{node.path}/{name}"
            assert "long_name" in column.attrs, f"{node.path}/{name}"


@pytest.mark.parametrize("scene", [COPPER, "runs/spall.toml", "runs/bilinear-p2-moc.toml"])
def test_groups_of_a_tree_have_their_own_times_without_those_handed_down(run, scene):
    with xarray.open_datatree(run(scene), engine="h5netcdf") as tree, h5py.File(run(scene)) as file:
        groups = [node for node in tree.subtree if "time" in file[node.path] and node.path != "/"]
        assert len(groups) > 2
        for node in groups:
            own = node.to_dataset(inherit=False)
            assert (own.time.values == file[node.path]["time"][:]).all(), node.path


def test_geometry_makes_forces_of_stresses(run):
    path = run("runs/stepped-bar.toml")
    fields, left = open_xarray(path), open_xarray(path, "ends/left")
    bar = open_xarray(path, "bar")
    bounds = fields.x_bounds.values
    assert bounds[0, 0] == 0 and bounds[-1, 1] == pytest.approx(float(bar.length))
    assert (bounds[1:, 0] == pytest.approx(bounds[:-1, 1])) and (bounds.mean(axis=1) == pytest.approx(fields.x.values))
    assert left.force.values == pytest.approx(left.stress.values * float(fields.area[0]))
    assert set(fields.area.values) == set(bar.area_left.values) | set(bar.area_right.values)


def test_ledger_balances(run):
    ledger = open_xarray(run(BILINEAR), "ledger")
    assert LEDGER <= set(ledger.variables)
    assert ledger.kinetic.dims == ("sample",)
    assert ledger.momentum.attrs["units"] in ("N s", "N s/m^2")
    # The discrete balance holds to round-off; thousands of steps gather some of it.
    assert float(abs(ledger.residual).max()) < 1e-10
    assert float(ledger.work_left[-1]) > 0


def test_audit_is_a_table_of_columns(run):
    audit = open_xarray(run(ABOVE), "audit")
    assert {"effect", "estimate", "threshold", "message"} <= set(audit.variables)
    assert audit.effect.dims == audit.message.dims == audit.estimate.dims
    with h5py.File(run(ABOVE)) as file:
        assert len(file["audit/message"].asstr()[:]) == audit.sizes[audit.effect.dims[0]] > 0


def test_materials_are_kept_as_used(run):
    with h5py.File(run(COPPER)) as file:
        (material,) = file["material"].values()
        assert material["stress"].shape == material["strain"].shape
        assert material["stress"].dims[0][0] == material["strain"]
        for sense in ("tension", "compression"):
            assert material[f"{sense}_stress"].dims[0][0] == material[f"{sense}_strain"]
            assert (material[f"{sense}_stress"][:] >= 0).all()
        assert material.attrs["density"] > 0
        assert material.attrs["citation"]


@pytest.mark.parametrize("compression, filter", [("lzf", "lzf"), ("none", None)])
def test_other_compressions_read_alike(run, compression, filter):
    path = run(COPPER, "--set", f'record.compression="{compression}"')
    with h5py.File(path) as file, h5py.File(run(COPPER)) as default:
        assert file["stress"].compression == filter
        assert np.array_equal(file["stress"][:], default["stress"][:])


def started(program, scene, output):
    """A run that has its file and has gone on for a second."""
    process = subprocess.Popen([program, "run", scene, "-o", output, "--quiet"], cwd=ROOT)
    deadline = time.monotonic() + 60
    while not output.exists():
        assert process.poll() is None, "the run ended before its file was there"
        assert time.monotonic() < deadline
        time.sleep(0.02)
    time.sleep(1.0)
    assert process.poll() is None, "the scene is too short for this test"
    return process


def assert_frames_are_sound(file):
    frames = file["time"].shape[0]
    assert 1 < frames < 20001
    assert (np.diff(file["time"][:]) > 0).all()
    for name in ("stress", "strain", "velocity"):
        values = file[name][:]
        assert values.shape[0] == frames
        assert np.isfinite(values).all()
    # The bar is pulled: the frames hold waves, not just zeros (the last of them may be of a bar at rest).
    assert abs(file["stress"][:]).max() > 1e5


def test_a_killed_run_leaves_its_frames(program, long_scene, tmp_path):
    output = tmp_path / "killed.h5"
    process = started(program, long_scene, output)
    process.kill()
    process.wait()
    # Killed between the changes of one flush, the file is completed by the next command that opens it.
    if output.with_name(f".{output.name}.journal").exists():
        subprocess.run([program, "report", output, "-o", tmp_path / "killed.svg"], check=True)
    with h5py.File(output) as file:
        assert file.attrs["outcome"] == "running"
        assert file.attrs["scene"] == long_scene.read_text()
        assert_frames_are_sound(file)
        assert file["gauges/middle/time"].shape == file["gauges/middle/stress"].shape
    assert open_xarray(output).stress.dims == ("time", "x")


def test_an_interrupted_run_closes_its_file(program, long_scene, tmp_path):
    output = tmp_path / "interrupted.h5"
    process = started(program, long_scene, output)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    with h5py.File(output) as file:
        assert file.attrs["outcome"] == "interrupted"
        assert file.attrs["wall_seconds"] > 0
        assert_frames_are_sound(file)
        assert "ledger" in file and "fronts" in file


def test_a_wrong_scene_leaves_an_older_result_alone(program, run, tmp_path):
    output = tmp_path / "result.h5"
    before = run(BILINEAR).read_bytes()
    output.write_bytes(before)
    wrong = subprocess.run([program, "run", BILINEAR, "-o", output, "--set", "solve.cells=-1"], cwd=ROOT)
    assert wrong.returncode == 2
    assert output.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["result.h5"]


@pytest.mark.parametrize("kind, start", [("svg", b"<svg"), ("png", b"\x89PNG"), ("html", b"<!DOCTYPE html>")])
def test_a_report_is_drawn(program, run, tmp_path, kind, start):
    output = tmp_path / f"figure.{kind}"
    subprocess.run([program, "report", run(COPPER), "-o", output], check=True)
    content = output.read_bytes()
    assert content.startswith(start)
    # Nothing is fetched from anywhere: the only addresses are names of XML languages.
    if kind != "png":
        assert set(re.findall(rb"https?://[^\"' )]+", content)) <= {b"http://www.w3.org/2000/svg"}


TRACKED = "runs/bilinear-p2-moc.toml"
LET_GO = "runs/copper-released.toml"


def test_a_tracked_run_opens_in_xarray_with_paths_numbered(run):
    # Warnings are errors here: every dimension has its scale.
    dataset = open_xarray(run(TRACKED))
    assert dataset.stress.dims == ("time", "x")
    assert dataset.sizes["x"] == 1000
    paths = open_xarray(run(TRACKED), "paths")
    assert paths.speed.dims == ("path",)
    assert (paths.path == np.arange(paths.sizes["path"])).all()
    # Even cell centres of a bar of 1 m.
    assert dataset.x.values == pytest.approx((np.arange(1000) + 0.5) / 1000, abs=1e-15)
    assert "state behind it" in dataset.stress.attrs["sampling"]


def test_paths_are_a_table_of_straight_pieces(run):
    with h5py.File(run(TRACKED)) as file:
        assert (file.attrs["method"], file.attrs["scheme"]) == ("moc", "front-tracking")
        assert file.attrs["events"] > 0 and file.attrs["cells"] == 0
    paths = open_xarray(run(TRACKED), "paths")
    assert paths.attrs["complete"] == 1
    assert set(paths.data_vars) == {"x0", "t0", "x1", "t1", "stress_jump", "speed"}
    paths = paths.to_dataframe().to_records()
    assert (paths["t1"] > paths["t0"]).all()
    assert paths["speed"] == pytest.approx((paths["x1"] - paths["x0"]) / (paths["t1"] - paths["t0"]), rel=1e-12)
    # All fronts of a bilinear bar run at one of two speeds.
    speeds = np.sqrt([200e9 / 7800, 20e9 / 7800])
    nearest = speeds[np.argmin(abs(abs(paths["speed"])[:, None] - speeds), axis=1)]
    assert abs(paths["speed"]) == pytest.approx(nearest, rel=1e-12)
    # The run's last moment is that of the fronts under way.
    fronts = open_xarray(run(TRACKED), "fronts").to_dataframe().to_records()
    assert fronts["position"][fronts["last_seen"] == 600e-6] == pytest.approx(
        np.sort(paths["x1"][paths["t1"] == 600e-6]), abs=1e-12
    )


def test_paths_can_be_left_out(run):
    with h5py.File(run(TRACKED, "--set", "record.paths=false")) as file:
        assert "paths" not in file
    with h5py.File(run(BILINEAR)) as file:
        assert "paths" not in file


def test_tracked_gauges_are_steps_of_two_rows(run):
    gauge = open_xarray(run(TRACKED), "gauges/quarter")
    time, stress = gauge.time.values, gauge.stress.values
    assert (np.diff(time) >= 0).all() and time[0] == 0 and time[-1] == 600e-6
    changes = np.flatnonzero(np.diff(stress))
    assert len(changes) > 3 and (time[changes] == time[changes + 1]).all()
    # The elastic front passes 0.25 m at 0.25 m/c0, the plastic one at its own speed.
    assert time[changes[0]] == pytest.approx(0.25 / np.sqrt(200e9 / 7800), rel=1e-13)
    assert time[changes[1]] == pytest.approx(0.25 / np.sqrt(20e9 / 7800), rel=1e-13)
    assert stress[changes[0] + 1] == pytest.approx(-200e6, rel=1e-13)
    assert stress[changes[1] + 1] == pytest.approx(-386.554e6, rel=1e-5)


def test_both_methods_agree_on_the_fields(run):
    exact = open_xarray(run(TRACKED, "--set", "solve.until=157.98734e-6", "--set", "record.frames=81"))
    grid = open_xarray(run(BILINEAR))
    missed = float(abs(exact.stress - grid.stress.values).isel(time=-1).sum() / abs(exact.stress).isel(time=-1).sum())
    # What the grid's own summary says of 1000 cells.
    assert missed < 0.0036


def test_a_long_tracked_run_balances(run):
    path = run(LET_GO)
    ledger = open_xarray(path, "ledger")
    # Nodes nearer than 1e-8 of the front tolerance (times the length) are taken as one.
    assert float(abs(ledger.residual).max()) < 1e-9
    total = ledger.kinetic + ledger.elastic + ledger.plastic + ledger.viscoplastic + ledger.numerical + ledger.half_step + ledger.concentrated
    assert float(total[-1]) == pytest.approx(float(ledger.work_left[-1]), rel=1e-9)
    with h5py.File(path) as file:
        assert file["paths"].attrs["complete"] == 1
        for side in ("left", "right"):
            assert (np.diff(file[f"ends/{side}/time"][:]) >= 0).all()


def test_a_tracked_report_draws_the_paths(program, run, tmp_path):
    output = tmp_path / "tracked.svg"
    subprocess.run([program, "report", run(TRACKED), "-o", output], check=True)
    text = output.read_text()
    assert "fronts, by strength" in text and "front speeds, theory" not in text


@pytest.fixture
def long_tracked_scene(tmp_path):
    """A scene whose fronts, every one sent, meet for a long time."""
    path = tmp_path / "long-tracked.toml"
    text = (ROOT / LET_GO).read_text()
    for old, new in [("front-tolerance = 1e-3", "front-tolerance = 0\nmax-events = 4e8"), ("frames = 201", "frames = 1000")]:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)
    return path


def test_a_killed_tracked_run_opens_without_a_warning(program, long_tracked_scene, tmp_path):
    output = tmp_path / "killed.h5"
    process = started(program, long_tracked_scene, output)
    process.kill()
    process.wait()
    # Killed between the changes of one flush, the file is completed by the next command that opens it.
    if output.with_name(f".{output.name}.journal").exists():
        subprocess.run([program, "report", output, "-o", tmp_path / "killed.svg"], check=True)
    with h5py.File(output) as file:
        assert file.attrs["outcome"] == "running"
        assert file["paths"].attrs["complete"] == 0
        assert file["paths/speed"].shape == file["paths/path"].shape
        assert file["paths/speed"].shape[0] > 0
        assert_frames_are_sound(file)
    dataset = open_xarray(output)
    assert dataset.stress.dims == ("time", "x")


def test_an_interrupted_tracked_run_closes_its_file(program, long_tracked_scene, tmp_path):
    output = tmp_path / "interrupted.h5"
    process = started(program, long_tracked_scene, output)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    with h5py.File(output) as file:
        assert file.attrs["outcome"] == "interrupted"
        assert file["paths"].attrs["complete"] == 0
        assert_frames_are_sound(file)
        assert file["fronts/origin"].shape[0] > 0
