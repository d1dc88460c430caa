#!/usr/bin/env bash
# All tests: those of the Rust code, those that read the program's result files with h5py and xarray, and a sweep on a cluster of Slurm.
# The Python packages go into a folder of their own under target/; nothing is installed elsewhere.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
python=${PYTHON:-python3}

cargo test --release --locked
target=$(cd -- "${CARGO_TARGET_DIR:-target}" && pwd)

if "$target/python/bin/python" -m pip --version >/dev/null 2>&1 || "$python" -m venv --clear "$target/python"; then
    python="$target/python/bin/python"
    "$python" -m pip install --quiet --disable-pip-version-check -r tests/python/requirements.txt
else
    echo "no venv with pip here: the packages go into $target/python-packages" >&2
    rm -rf -- "$target/python" "$target/python-packages"
    "$python" -m pip install --quiet --disable-pip-version-check --target "$target/python-packages" \
        -r tests/python/requirements.txt
    export PYTHONPATH="$target/python-packages"
fi
BARWAVE_BIN="$target/release/barwave" "$python" -m pytest -q -rs -p no:cacheprovider tests/python
tests/slurm.sh "$target/release/barwave"
