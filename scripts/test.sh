#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors, and runs all tests.
# Usage: scripts/test.sh [PRESET]   (release, debug or asan; default: release)
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}

scripts/install_dependencies.sh
cmake --preset "$preset" -DTUBEBIN_WERROR=ON
cmake --build --preset "$preset"
ctest --preset "$preset"
