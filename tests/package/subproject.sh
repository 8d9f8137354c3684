#!/usr/bin/env bash
# add_subdirectory: a project that holds tubebin and its examples beside a program of its own builds that one, and its `install`
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
add_subdirectory($source/examples/cpp examples EXCLUDE_FROM_ALL)
add_executable(robot robot.cpp)
target_link_libraries(robot PRIVATE tubebin::tube)
install(TARGETS robot)
END
cat > "$work/robot.cpp" << END
#include <tubebin/tube/tube_generator.hpp>

int main() {
  tubebin::Random random(1);
  return tubebin::tube::generate_tubes(3, {}, random).size() == 3 ? 0 : 1;
}
END
# Nothing here depends on speed: the quickest way to build.
cmake -S "$work" -B "$work/build" -DCMAKE_CXX_FLAGS=-O0 -DCMAKE_UNITY_BUILD=ON > "$work/log" || { cat "$work/log"; exit 1; }
cmake --build "$work/build" --parallel 2 > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
cmake --install "$work/build" --prefix "$work/usr" > /dev/null
[ "$(cd "$work/usr" && find . -type f)" = ./bin/robot ] || { find "$work/usr" -type f; exit 1; }
"$work/usr/bin/robot"
