#!/usr/bin/env bash
# Installs what is missing, builds, and generates a small data set of the paper's sets A and B with pictures.
# Usage: scripts/demo.sh [FOLDER]   (default: datasets_demo)
set -euo pipefail
output=$(realpath -m "${1:-datasets_demo}")
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh
cmake --preset release
cmake --build --preset release

for set in a b; do
  echo
  echo "Set ${set^^}:"
  build/bin/generate_dataset "config/set_$set.yaml" --output "$output/set_$set" --tubes 1,5,10 --cases 3 --preview
done

echo
echo "The data sets are in $output/set_a and $output/set_b."
echo "Look at $output/set_a/A10/001/preview.png; its point cloud is cloud.pcd beside it."
