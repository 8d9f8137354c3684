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

# Where a package registry is reachable no test skips for want of a Python package.
check_skips() {
  [ -n "$environment" ] || return 0
  ! grep -A 1 -E '(: Skipped|^skipped:)' "$1/Testing/Temporary/LastTest.log" | grep -iE 'python3|No module named' ||
    { echo "Tests skipped although the Python environment $environment is there." >&2; return 1; }
}

scripts/install_dependencies.sh --tests
environment=$(scripts/python_environment.sh) ||
  { environment=; echo "No Python packages to be had: tests that compare with them skip." >&2; }
export PATH="${environment:+$environment/bin:}$PATH"
options=(-DTUBEBIN_WERROR=ON)
# The wheel is made of what this build compiles (tests/package/python_wheel.sh).
[ "$preset" != ci ] || [ -z "$environment" ] || options+=(-DTUBEBIN_PYTHON=ON)
cmake --preset "$preset" "${options[@]}"
if [ ${#kinds[@]} -eq 0 ]; then
  build
  ctest --preset "$preset"
else
  build --target "${kinds[@]/%/_tests}"
  ctest --preset "$preset" --label-regex "^($(IFS='|'; echo "${kinds[*]}"))$"
fi
case "$preset" in release) check_skips build ;; *) check_skips "build-$preset" ;; esac
