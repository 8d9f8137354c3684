#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors, and runs the tests.
# Usage: scripts/test.sh [PRESET [KIND...]]
#   PRESET  release, debug, ci, asan or tsan; default: release
#   KIND    unit, scene, fault, browser, bench or package: builds and runs these alone; default: all
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}
kinds=("${@:2}")

# Where a name stands in two files of one unit, large units can't be compiled, and it takes file by file.
build() {
  cmake --build --preset "$preset" "$@" && return
  cmake --preset "$preset" -N -L | grep 'CMAKE_UNITY_BUILD="ON"' > /dev/null || return 1
  echo "Failed in large units (CONTRIBUTING.md); building file by file"
  cmake --preset "$preset" -DTUBEBIN_WERROR=ON -DCMAKE_UNITY_BUILD=OFF
  cmake --build --preset "$preset" "$@"
}

scripts/install_dependencies.sh
cmake --preset "$preset" -DTUBEBIN_WERROR=ON
if [ ${#kinds[@]} -eq 0 ]; then
  build
  ctest --preset "$preset"
else
  build --target "${kinds[@]/%/_tests}"
  ctest --preset "$preset" --label-regex "^($(IFS='|'; echo "${kinds[*]}"))$"
fi
