#!/usr/bin/env bash
# Prints how well and how fast model_tubes works (docs/performance.md has the figures): generates sets A and B from a
# seed of their own, models every cloud by both methods, and times stock PCL in the same run.
# usage: scripts/bench_modeling.sh [--cases N] [--tubes 1,2,5,10,20] [--seed S] [--output DIR]
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
cases=20
tubes=1,2,5,10,20
seed=4711
output=$root/build/bench/modeling

while [[ $# -gt 0 ]]; do
  case $1 in
    --cases) cases=$2; shift 2 ;;
    --tubes) tubes=$2; shift 2 ;;
    --seed) seed=$2; shift 2 ;;
    --output) output=$2; shift 2 ;;
    *) echo "usage: $0 [--cases N] [--tubes 1,2,5,10,20] [--seed S] [--output DIR]" >&2; exit 2 ;;
  esac
done

cmake -S "$root" -B "$root/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTUBEBIN_BENCH=ON >/dev/null
cmake --build "$root/build" --target generate_dataset modeling_table
for set in a b; do
  "$root/build/bin/generate_dataset" "$root/config/set_$set.yaml" --output "$output/set_$set" \
    --tubes "$tubes" --cases "$cases" --seed "$seed" --quiet >/dev/null
done
"$root/build/bench/modeling_table" "$output/set_a" "$output/set_b"
