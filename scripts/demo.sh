#!/usr/bin/env bash
# Installs what is missing, builds, generates a small data set of the paper's sets A and B with pictures, models its
# tubes, and measures how well they were found.
# Usage: scripts/demo.sh [FOLDER]   (default: datasets_demo)
set -euo pipefail
output=$(realpath -m "${1:-datasets_demo}")
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh
cmake --preset release
cmake --build --preset release --target generate_dataset model_tubes evaluate view

for set in a b; do
  echo
  echo "Set ${set^^}:"
  build/bin/generate_dataset "config/set_$set.yaml" --output "$output/set_$set" --tubes 1,5,10 --cases 3 --preview
  build/bin/model_tubes "$output/set_$set" --output "$output/results_$set" --ratios 0.3,1.0
done

echo
build/bin/evaluate "$output/results_a" "$output/results_b" --html "$output/report.html"
build/bin/view "$output/results_a" --html "$output/view.html" > /dev/null

echo
echo "The data sets are in $output/set_a and $output/set_b, what was found in $output/results_a and results_b."
echo "Look at $output/set_a/A10/001/preview.png; its point cloud is cloud.pcd beside it."
echo "For a browser: the report, $output/report.html, and what was found in set A, to turn in 3D: $output/view.html"
