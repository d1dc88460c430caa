#!/usr/bin/env bash
# A sweep on a cluster: starts a Slurm of one node, runs a job array of four tasks, merges their shards and compares the table with that of
# a single run, byte for byte. A step of two tasks does the same. Nothing is installed: Debian's packages are unpacked under target/, and
# the daemons run in a folder of their own until the script ends. Where the packages cannot be had, the test is skipped.
#
# Usage: tests/slurm.sh [path to barwave]
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
target=$(cd -- "${CARGO_TARGET_DIR:-target}" && pwd)
barwave=$(realpath -- "${1:-$target/release/barwave}")
slurm=$target/slurm
sweep=$PWD/examples/sweeps/impact-velocity.toml
array=$PWD/examples/sweeps/array.sbatch

skip() {
    echo "Slurm test skipped: $1"
    exit 0
}

# Slurm, and what the machine lacks of its dependencies.
download() {
    mkdir -p -- "$slurm/packages/partial"
    timeout 120 apt-get -qq -y --no-install-recommends --reinstall --download-only -o Debug::NoLocking=1 \
        -o Dir::Cache::archives="$slurm/packages" install slurmctld slurmd slurm-client slurm-wlm-basic-plugins munge >"$slurm/apt.log" 2>&1
}

unpack() {
    rm -rf -- "$slurm/root"
    local package
    for package in "$slurm"/packages/*.deb; do
        dpkg-deb -x "$package" "$slurm/unpacking"
    done
    mv -- "$slurm/unpacking" "$slurm/root"
}

# Two ports on which nothing listens and which no connection holds, below those that the system gives to connections.
free_ports() {
    python3 - <<END
import random, socket
with socket.socket() as one, socket.socket() as other:
    for each in one, other:
        while True:
            try:
                each.bind(("127.0.0.1", random.randrange(10000, 32000)))
                break
            except OSError:
                pass
    print(one.getsockname()[1], other.getsockname()[1])
END
}

configure() {
    local host ports
    host=$(hostname -s)
    read -ra ports < <(free_ports)
    rm -rf -- "$run/state" "$run/spool"
    mkdir -- "$run/state" "$run/spool"
    (umask 077 && head -c 1024 /dev/urandom >"$run/key")
    cat >"$run/slurm.conf" <<END
ClusterName=barwave
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports[0]}
SlurmdPort=${ports[1]}
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthInfo=socket=$run/munge
PluginDir=$plugins
StateSaveLocation=$run/state
SlurmdSpoolDir=$run/spool
SlurmctldPidFile=$run/slurmctld.pid
SlurmdPidFile=$run/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
# Four tasks at a time, whatever the machine has.
SlurmdParameters=config_overrides
NodeName=$host NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
END
}

start() {
    munged --foreground --force --key-file="$run/key" --socket="$run/munge" --pid-file="$run/munged.pid" \
        --seed-file="$run/seed" >"$run/munged.log" 2>&1 &
    daemons+=($!)
    slurmctld-wlm -D >"$run/slurmctld.log" 2>&1 &
    daemons+=($!)
    slurmd-wlm -D -d "$slurm/root/usr/sbin/slurmstepd-wlm" >"$run/slurmd.log" 2>&1 &
    daemons+=($!)
    local _
    for _ in {1..60}; do
        # A port may have been taken meanwhile.
        (($(jobs -pr | wc -l) == ${#daemons[@]})) || { echo "a daemon of Slurm has ended" && return 1; }
        [[ $(timeout 5 sinfo -h -o %T 2>/dev/null) == idle ]] && return
        sleep 0.5
    done
    echo "the node of Slurm did not come up in 30 s"
    return 1
}

end_daemons() {
    local daemon
    # The first one, munged, serves the others until they have ended.
    for ((daemon = ${#daemons[@]} - 1; daemon >= 0; daemon--)); do
        kill "${daemons[daemon]}" 2>/dev/null || true
        wait "${daemons[daemon]}" 2>/dev/null || true
    done
    daemons=()
}

stop() {
    local status=$? _
    trap - EXIT
    if ((${#daemons[@]})); then
        timeout 5 scancel --user="$(id -un)" 2>/dev/null || true
        for _ in {1..20}; do
            [[ -z $(timeout 5 squeue -h 2>/dev/null) ]] && break
            sleep 0.5
        done
        end_daemons
    fi
    ((status == 0)) || tail -n 20 -- "$run"/*.log "$run"/*.out 2>/dev/null || true
    rm -rf -- "$run"
    exit "$status"
}

same_table() {
    "$barwave" merge "$1" -o "$1.h5"
    cmp -- "$1.csv" "$run/single/table.csv"
}

if [[ ! -x $slurm/root/usr/bin/sbatch ]]; then
    command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || skip "this is no Debian"
    mkdir -p -- "$slurm"
    download || { timeout 120 apt-get -qq update >/dev/null 2>&1 && download; } ||
        skip "its packages cannot be fetched ($slurm/apt.log)"
    unpack
fi
libraries=$(dirname -- "$slurm"/root/usr/lib/*/slurm-wlm)
plugins=$libraries/slurm-wlm
# Short, because the names of sockets are.
run=$(mktemp -d /tmp/barwave-slurm.XXXXXX)
daemons=()
trap stop EXIT
trap 'exit 130' INT TERM
export SLURM_CONF=$run/slurm.conf LD_LIBRARY_PATH=$libraries:$plugins
# The program under the name that the script of the array calls.
mkdir -- "$run/bin"
ln -s -- "$barwave" "$run/bin/barwave"
PATH=$slurm/root/usr/sbin:$slurm/root/usr/bin:$run/bin:$PATH

for attempt in 1 2 3; do
    configure
    start && break
    ((attempt < 3))
    end_daemons
done
cd -- "$run"
"$barwave" sweep "$sweep" -o single --quiet
timeout 300 sbatch --quiet --wait --array=1-4 "$array" "$sweep" array
[[ $(echo array/shard-*-of-4/rows.jsonl | wc -w) == 4 ]] || { echo "the array ran no four shards"; exit 1; }
same_table array
timeout 300 srun --quiet --ntasks=2 barwave sweep "$sweep" -o step --quiet
[[ $(echo step/shard-*-of-2/rows.jsonl | wc -w) == 2 ]] || { echo "the step ran no two shards"; exit 1; }
same_table step
echo "Slurm test passed: the shards of a job array and of a step give the table of a single run"
