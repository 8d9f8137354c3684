#!/usr/bin/env bash
# add_subdirectory: a project that holds tubebin beside programs of its own builds one of the examples, and its `install`
# installs nothing of tubebin's.
# Usage: tests/package/subproject.sh
set -euo pipefail
source=$(realpath "$(dirname "$0")/../..")
work=$(mktemp -d /tmp/tubebin_subproject_XXXXXX)
trap 'rm -rf "$work"' EXIT
cat > "$work/CMakeLists.txt" << END
cmake_minimum_required(VERSION 3.22)
project(robot LANGUAGES C CXX)
add_subdirectory($source tubebin EXCLUDE_FROM_ALL)
add_subdirectory($source/examples/cpp examples)
install(FILES CMakeLists.txt DESTINATION robot)
END
# Nothing here depends on speed: the quickest way to build.
cmake -S "$work" -B "$work/build" -DCMAKE_CXX_FLAGS=-O0 -DCMAKE_UNITY_BUILD=ON > "$work/log" || { cat "$work/log"; exit 1; }
cmake --build "$work/build" --parallel 2 --target 1_generate_scene > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
(cd "$work" && build/examples/1_generate_scene && grep -q '"tubes"' scene.json)
cmake --install "$work/build" --prefix "$work/usr" > /dev/null
[ "$(cd "$work/usr" && find . -type f)" = ./robot/CMakeLists.txt ] || { find "$work/usr" -type f; exit 1; }
