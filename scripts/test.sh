#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors, and runs the tests.
# Usage: scripts/test.sh [PRESET [KIND...]]
#   PRESET  release, debug, ci, asan or tsan; default: release
#   KIND    unit, scene, fault or browser: builds and runs these alone; default: all
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}
kinds=("${@:2}")

scripts/install_dependencies.sh
cmake --preset "$preset" -DTUBEBIN_WERROR=ON
if [ ${#kinds[@]} -eq 0 ]; then
  cmake --build --preset "$preset"
  ctest --preset "$preset"
else
  cmake --build --preset "$preset" --target "${kinds[@]/%/_tests}"
  ctest --preset "$preset" --label-regex "^($(IFS='|'; echo "${kinds[*]}"))$"
fi
