"""Runs scenes through the real program, once each.

The program is $BARWAVE_BIN, or else target/release/barwave. Install the packages of requirements.txt, then
`pytest tests/python`.
"""

import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = pathlib.Path(os.environ.get("BARWAVE_BIN", ROOT / "target" / "release" / "barwave")).resolve()


@pytest.fixture(scope="session")
def program():
    assert BINARY.is_file(), f"{BINARY} is missing: cargo build --release, or set BARWAVE_BIN"
    return BINARY


@pytest.fixture(scope="session")
def run(program, tmp_path_factory):
    """run("runs/x.toml") -> path of its result file."""
    folder = tmp_path_factory.mktemp("results")
    done = {}

    def run_once(scene, *arguments):
        key = (str(scene), *arguments)
        if key not in done:
            path = folder / f"{len(done)}.h5"
            subprocess.run([program, "run", scene, "-o", path, "--quiet", *arguments], cwd=ROOT, check=True)
            done[key] = path
        return done[key]

    return run_once


@pytest.fixture
def long_scene(tmp_path):
    """A scene that computes for a good while and records often."""
    path = tmp_path / "long.toml"
    path.write_text(
        """
title = "A long run"
[bar]
length = "1 m"
material = "copper-annealed"
[left]
kind = "velocity"
value = "-30 m/s"
[right]
kind = "free"
[effects]
hardening = "isotropic"
[solve]
until = "20 ms"
cells = 20000
[record]
frames = 20001
cells = 500
gauges = { middle = "0.5 m" }
"""
    )
    return path
