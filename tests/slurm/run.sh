#!/usr/bin/env bash
# The templates of scripts/slurm/ on a real Slurm: starts one of its own on this machine (munged, slurmctld, slurmd, all
# on loopback, nothing outside a temporary folder), submits a whole experiment, kills one task and requeues another in the
# middle, and compares every byte with what one machine makes. Ends exactly the processes that it started.
# Usage: tests/slurm/run.sh BIN_DIR      exit code 77: not possible here, with the reason
set -euo pipefail
bin=$(realpath "$1")
source=$(realpath "$(dirname "$0")/../..")
export PATH=$PATH:/usr/sbin:/sbin

skip() {
  echo "skipped: $*"
  exit 77
}
for program in munged munge slurmctld slurmd sbatch scontrol squeue sinfo python3 pgrep; do
  command -v "$program" > /dev/null || skip "$program is not installed (Debian: slurm-wlm munge python3 procps)"
done
[ "$(id -u)" -eq 0 ] || skip "slurmd needs root"

work=$(mktemp -d /tmp/tubebin_slurm_XXXXXX)
started=()
finish() {
  local code=$?
  if [ "$code" -ne 0 ] && [ "$code" -ne 77 ]; then
    tail -n 30 "$work"/*.log "$work"/*.out 2> /dev/null || true
  fi
  # Jobs first, while there is someone to end them; then the daemons, the last one first.
  if [ -f "$work/slurm.conf" ]; then scancel --full --signal=KILL --user=root 2> /dev/null || true; fi
  for ((i = ${#started[@]} - 1; i >= 0; --i)); do
    kill "${started[i]}" 2> /dev/null || true
    for _ in $(seq 100); do kill -0 "${started[i]}" 2> /dev/null && sleep 0.1 || break; done
    kill -9 "${started[i]}" 2> /dev/null || true
    wait "${started[i]}" 2> /dev/null || true
  done
  rm -rf "$work"
  exit "$code"
}
trap finish EXIT

# start NAME COMMAND...: a daemon in the foreground, as a child of this script.
start() {
  local name=$1
  shift
  "$@" > "$work/$name.out" 2>&1 &
  started+=($!)
}
# wait_for SECONDS COMMAND...
wait_for() {
  local deadline=$((SECONDS + $1))
  shift
  until "$@"; do
    [ $SECONDS -lt $deadline ] || return 1
    sleep 0.3
  done
}
free_port() { python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'; }

chmod 755 "$work"
mkdir "$work/munge" "$work/state" "$work/spool"
head -c 1024 /dev/urandom > "$work/munge/key"
chmod 600 "$work/munge/key"
start munged munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge/socket" \
  --pid-file="$work/munge/pid" --log-file="$work/munged.log" --seed-file="$work/munge/seed"
munge_works() { munge --no-input --socket="$work/munge/socket" > /dev/null 2>&1; }
wait_for 20 munge_works || skip "munged does not start: $(tail -n 1 "$work/munged.log" "$work/munged.out")"

node=$(hostname -s)
cat > "$work/slurm.conf" << CONF
ClusterName=tubebin
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
# A requeued job waits until its credential has expired.
AuthInfo=socket=$work/munge/socket,cred_expire=8
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=1,sched_interval=2,batch_sched_delay=0,sched_min_interval=0
JobRequeue=1
ReturnToService=2
# Two tasks at once, however few cores the machine has.
SlurmdParameters=config_overrides
KillWait=5
MinJobAge=3600
MailProg=/bin/true
NodeName=$node NodeAddr=127.0.0.1 CPUs=4 RealMemory=1000 State=UNKNOWN
PartitionName=test Nodes=$node Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
CONF
export SLURM_CONF=$work/slurm.conf
start slurmctld slurmctld -D -c
start slurmd slurmd -D -N "$node"
is_idle() { [ "$(sinfo --noheader --format=%T 2> /dev/null)" = idle ]; }
wait_for 60 is_idle || skip "slurmd does not come up: $(tail -n 3 "$work/slurmd.log" "$work/slurmctld.log" 2> /dev/null)"
echo "Slurm $(slurmctld -V | cut -d' ' -f2) runs on $node"

# Enough scenes that there is a middle; one core a task, two tasks at once.
cat > "$work/quick.yaml" << 'CONFIG'
set: Q
seed: 5
tubes: [1, 3, 6]
cases: 150
tube: {length: 0.2, cylinder_count_max: 6}
scanner: {width: 320, height: 200}
CONFIG
cd "$work"
export TUBEBIN_BIN=$bin SBATCH_MEM_PER_CPU=64M SBATCH_TIMELIMIT=30
export MODEL_OPTIONS="--radius 0.0125 --tube-length 0.2 --ratios 0.3,1"
jobs=$("$source/scripts/slurm/submit.sh" "$work/quick.yaml" "$work/data" "$work/results" 4)
echo "$jobs"
id_of() { sed -E "s/.*$1 ([0-9]+).*/\1/" <<< "$jobs"; }
generate=$(id_of generate)

# Task 2 dies a violent death, task 1 is requeued as preemption does it, both when they have made something.
log_of() { echo "$work/tubebin-generate-${generate}_$1.log"; }
records_of() { cat "$work"/data/manifest.parts/"0000$1-of-00004".* 2> /dev/null | wc -l; }
is_halfway() { [ "$(records_of "$1")" -ge 5 ]; }
process_of() { # the program of the task, not one of its workers, found by the job that its environment names
  local job pid
  job=$(scontrol show job "${generate}_$1" --oneliner | sed -E 's/^JobId=([0-9]+) .*/\1/')
  for pid in $(pgrep --exact generate_datase); do # the kernel keeps 15 letters of a name
    if [ "$(ps --no-headers -o comm= --ppid "$pid" | head -n 1)" = generate_datase ] &&
      tr '\0' '\n' < "/proc/$pid/environ" 2> /dev/null | grep -qx "SLURM_JOB_ID=$job"; then
      echo "$pid"
      return
    fi
  done
}
for task in 2 1; do
  wait_for 120 is_halfway $task || { echo "task $task made nothing"; exit 1; }
  if [ $task = 2 ]; then
    pid=$(process_of 2)
    [ -n "$pid" ] || { echo "task 2 had ended already, after $(records_of 2) scenes"; exit 1; }
    kill -9 "$pid"
    echo "killed task 2 after $(records_of 2) scenes"
  else
    scontrol requeue "${generate}_1"
    echo "requeued task 1 after $(records_of 1) scenes"
  fi
done

is_over() { [ -z "$(squeue --noheader --format=%i)" ]; }
wait_for 420 is_over || { squeue; exit 1; }
for stage in generate merge model evaluate; do
  for log in tubebin-"$stage"-*.log; do echo "== $log" && cat "$log"; done
done
for task in 1 2; do
  grep -q 'restart 1' "$(log_of $task)" || { echo "task $task was not started again"; exit 1; }
  # What it had made was kept.
  grep -qE 'scenes are complete: [0-9]+ made in [0-9.]+ s, ([5-9]|[1-9][0-9]+) were there before' "$(log_of $task)" ||
    { echo "task $task did not go on where it was"; exit 1; }
done
grep -q '450 of 450 scenes are complete and sound, 0 are missing' tubebin-merge-*.log
grep -q 'SLURM_ARRAY_TASK_ID=3' "$(log_of 3)"

echo "== one machine"
"$bin/generate_dataset" "$work/quick.yaml" --output "$work/one" --jobs 2 --quiet > /dev/null
"$bin/model_tubes" "$work/one" --output "$work/one_results" --jobs 2 --quiet ${MODEL_OPTIONS} > /dev/null
"$bin/evaluate" "$work/one_results" > "$work/one.txt"
# Manifests but for the times, and in order, since one machine's is in the order of completion.
records() { python3 -c '
import json, sys
for line in sorted(open(sys.argv[1])):
    record = json.loads(line)
    del record["seconds"]
    print(json.dumps(record))' "$1"; }
diff <(records "$work/data/manifest.jsonl") <(records "$work/one/manifest.jsonl")
diff -r --exclude=.lock --exclude=manifest.jsonl "$work/data" "$work/one"
diff -r --exclude=.lock --exclude=times.json --exclude=index.json --exclude=report.html "$work/results" "$work/one_results"
"$bin/evaluate" "$work/results" --format csv | cut -d, -f1-8 > "$work/shards.csv"
"$bin/evaluate" "$work/one_results" --format csv | cut -d, -f1-8 > "$work/one.csv"
diff "$work/shards.csv" "$work/one.csv"
echo "The same bytes: $(find "$work/data" -type f | wc -l) files of the data set, $(find "$work/results" -type f | wc -l) of the results"
