#!/usr/bin/env bash
# Counts the instructions of three small, fixed jobs (tests/bench/jobs.cpp) with valgrind's callgrind and compares them
# with the figures in tests/bench/instruction_counts.txt. Unlike times they hardly depend on the machine or its load.
# Usage: scripts/instruction_counts.sh update                            build, count and write the figures anew
#        scripts/instruction_counts.sh check JOB BENCH_JOBS "COMPILER BUILD_TYPE"   as ctest -L bench does; 77: skipped
set -euo pipefail
cd "$(dirname "$0")/.."
figures=tests/bench/instruction_counts.txt
tolerance_percent=10

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Embree and glibc choose their code by the processor. Valgrind shows them one and the same processor on every machine
# that has AVX2, so that the counts agree.
count() {  # BENCH_JOBS JOB
  valgrind --tool=callgrind --callgrind-out-file="$scratch/out" --collect-atstart=no \
    --toggle-collect=tubebin_run_job "$1" "$2" 2> "$scratch/log" || { cat "$scratch/log" >&2; return 1; }
  awk '/^(summary|totals):/ {print $2; exit}' "$scratch/out"
}

check() {  # JOB BENCH_JOBS BUILD
  command -v valgrind > /dev/null || { echo "skipped: valgrind is missing"; exit 77; }
  grep -qw avx2 /proc/cpuinfo || { echo "skipped: this processor has no AVX2"; exit 77; }
  local build
  build=$(sed -n 's/^build: //p' "$figures")
  [ "$3" = "$build" ] || { echo "skipped: the figures are of $build, this is $3"; exit 77; }
  local expected counted percent
  expected=$(sed -n "s/^$1: //p" "$figures")
  counted=$(count "$2" "$1")
  percent=$(awk -v a="$counted" -v b="$expected" 'BEGIN {printf "%+.1f", 100 * (a / b - 1)}')
  echo "$1: $counted instructions, $percent % beside the $expected of $figures"
  awk -v p="$percent" -v t="$tolerance_percent" 'BEGIN {exit !(p <= t && p >= -t)}' && return
  echo "That is more than $tolerance_percent % off. If it is meant (or a gain), write the new figures with" \
    "'$0 update' and commit them with the change."
  return 1
}

update() {
  scripts/install_dependencies.sh --tests valgrind
  cmake --preset release > /dev/null
  cmake --build --preset release --target bench_jobs
  local build
  build=$(ctest --test-dir build -R InstructionCounts.model -V -N | sed -n 's/.*"\([A-Za-z]* [0-9]* [A-Za-z]*\)"$/\1/p')
  {
    echo "# Instructions of the jobs in tests/bench/jobs.cpp; written by scripts/instruction_counts.sh update."
    echo "build: $build"
    for job in generate model evaluate; do echo "$job: $(count build/tests/bench_jobs $job)"; done
  } > "$scratch/figures"
  mv "$scratch/figures" "$figures"
  cat "$figures"
}

case "${1:-}" in
  check) check "${@:2}" ;;
  update) update ;;
  *) sed -n '2,5s/^# //p' "$0" >&2; exit 2 ;;
esac
