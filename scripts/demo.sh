#!/usr/bin/env bash
# Installs what is missing, builds, generates a small data set of the paper's sets A and B with pictures, models its
# tubes, and measures how well they were found. Says before each step how long it takes on two idle cores.
# Usage: scripts/demo.sh [FOLDER]   (default: datasets_demo)
set -euo pipefail
output=$(realpath -m "${1:-datasets_demo}")
cd "$(dirname "$0")/.."

step() { printf '\n== %s\n' "$*"; }

step "1 of 4: install what is missing. Nothing to do, or, on a bare machine, minutes by the network: 180 MB."
scripts/install_dependencies.sh

step "2 of 4: build four programs: three minutes the first time."
cmake --preset demo
cmake --build --preset demo

step "3 of 4: generate 18 scenes with pictures, and find their tubes: half a minute."
for set in a b; do
  build-demo/bin/generate_dataset "config/set_$set.yaml" --output "$output/set_$set" --tubes 1,5,10 --cases 3 --preview
  build-demo/bin/model_tubes "$output/set_$set" --output "$output/results_$set" --ratios 0.3,1.0
done

step "4 of 4: score what was found: seconds."
build-demo/bin/evaluate "$output/results_a" "$output/results_b" --html "$output/report.html"
build-demo/bin/view "$output/results_a" --html "$output/view.html" > /dev/null

echo
echo "The data sets are in $output/set_a and $output/set_b, what was found in $output/results_a and results_b."
echo "Look at $output/set_a/A10/001/preview.png; its point cloud is cloud.pcd beside it."
echo "For a browser: the report, $output/report.html, and what was found in set A, to turn in 3D: $output/view.html"
echo
echo "Try next, pipes, forks, rings, hoses and balls in one bin:"
printf '  build-demo/bin/generate_dataset config/mixed.yaml --output %q --tubes 12 --cases 1 --preview\n' "$output/mixed"
