"""A sweep on a Dask cluster: every shard is a task.

    python examples/sweeps/dask_sweep.py examples/sweeps/impact-velocity.toml speeds --shards 8

Without --scheduler the workers are processes of this machine. The result is the table speeds.csv and speeds.h5, the same as that of one
`barwave sweep`. A second call continues a sweep that was stopped: --resume runs only the cases that have no row yet.
"""

import argparse
import subprocess

from distributed import Client, as_completed


def run_shard(program, sweep, folder, shard):
    """Runs in a worker. The folder is one that all workers share."""
    command = [program, "sweep", sweep, "-o", folder, "--shard", shard, "--threads", "1", "--resume", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"shard {shard}: {done.stderr}")
    return shard


def main():
    parser = argparse.ArgumentParser(description="Runs a sweep on a Dask cluster and merges its shards.")
    parser.add_argument("sweep", help="the sweep file")
    parser.add_argument("folder", help="folder of the shards; the tables are written beside it, as FOLDER.h5 and FOLDER.csv")
    parser.add_argument("--shards", type=int, default=4, help="number of tasks [default: 4]")
    parser.add_argument("--scheduler", help="address such as tcp://node1:8786 [default: workers on this machine]")
    parser.add_argument("--program", default="barwave", help="path of barwave on the workers [default: barwave]")
    arguments = parser.parse_args()

    with Client(arguments.scheduler, dashboard_address=None) as client:
        shards = [f"{index}/{arguments.shards}" for index in range(1, arguments.shards + 1)]
        # A worker that is lost with its machine is replaced: its shard runs again, from the rows that it left.
        tasks = client.map(lambda shard: run_shard(arguments.program, arguments.sweep, arguments.folder, shard), shards, retries=2)
        for finished, task in enumerate(as_completed(tasks), start=1):
            print(f"shard {task.result()} done ({finished} of {arguments.shards})", flush=True)
    subprocess.run([arguments.program, "merge", arguments.folder, "-o", f"{arguments.folder}.h5"], check=True)


if __name__ == "__main__":
    main()
