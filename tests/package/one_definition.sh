#!/usr/bin/env bash
# One definition rule: no two types of one name with different layouts in one program. Links the program that needs most
# modules, with what the compiler knows of all their types; symbols are another link's matter, since linking so knows no --wrap.
# Types are all that counts, so templates get no code.
# One unit holds src/scan: of functions that are compiled twice (TUBEBIN_WIDE) GCC 12 takes the two for different ones.
# Usage: tests/package/one_definition.sh BUILD_DIR
set -euo pipefail
source=$(realpath "$(dirname "$0")/../..")
build=$(realpath "$1")/one-definition
flags="-O0 -flto -fno-implicit-templates -fno-implicit-inline-templates"
cmake -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS="$flags" \
  -DCMAKE_EXE_LINKER_FLAGS="-flto=auto -Wodr -Werror -Wl,--unresolved-symbols=ignore-all" -DCMAKE_AR="$(command -v gcc-ar)" \
  -DCMAKE_RANLIB="$(command -v gcc-ranlib)" -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=20 \
  -DTUBEBIN_TESTS=OFF > "$build.log" 2>&1 || { cat "$build.log"; exit 1; }
cmake --build "$build" --target export_dataset
