#!/usr/bin/env bash
# Checks the formatting of all C++ files, and src/, apps/ and, where nanobind is to be had, python/ with clang-tidy, by the
# rules in .clang-format and .clang-tidy. Later versions format otherwise, so the version is fixed.
# Usage: scripts/lint.sh           check; fails and names each place
#        scripts/lint.sh --format  write the formatting
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh clang-format-14 clang-tidy-14
cpp_files() { find "$@" \( -name '*.cpp' -o -name '*.hpp' \) -print0 | sort -z; }

if [ "${1:-}" = --format ]; then
  cpp_files apps bench examples include python src tests | xargs -0 clang-format-14 -i
  exit 0
fi

cpp_files apps bench examples include python src tests | xargs -0 clang-format-14 --dry-run --Werror ||
  { echo "Formatting differs; scripts/lint.sh --format writes it." >&2; exit 1; }

# clang-tidy spends its time on the headers, so it gets a few units of many files each: a fifth of the work. Where a name
# stands in two files of one unit that fails, and it takes file by file.
# Warnings are GCC's to give (-w), and clang 14 lacks the -mtls-dialect that nanobind asks for. clang-tidy counts the warnings
# of system headers on stderr.
environment=$(scripts/python_environment.sh) && has_nanobind=ON || has_nanobind=OFF
tidy() {  # UNITY (ON or OFF)
  cmake -S . -B build-lint -G Ninja -DTUBEBIN_TESTS=OFF -DCMAKE_UNITY_BUILD="$1" -DCMAKE_UNITY_BUILD_BATCH_SIZE=16 \
    -DTUBEBIN_PYTHON=$has_nanobind -DPython_EXECUTABLE="$environment/bin/python" -DNB_HAS_MTLS_GNU2=OFF > /dev/null
  sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' build-lint/compile_commands.json | grep -v nanobind |
    xargs -d '\n' -n 1 -P "$(nproc)" clang-tidy-14 -p build-lint --quiet --extra-arg=-w 2> >(grep -vE '^[0-9]+ warnings? ' >&2)
}
tidy ON || { echo "Found something in large units; checking file by file"; tidy OFF; } ||
  { echo "clang-tidy found something." >&2; exit 1; }
