#!/usr/bin/env bash
# Checks the formatting of all C++ files, and src/ and apps/ with clang-tidy, by the rules in .clang-format and
# .clang-tidy. Later versions format otherwise, so the version is fixed.
# Usage: scripts/lint.sh           check; fails and names each place
#        scripts/lint.sh --format  write the formatting
# clang-tidy reads the compilation database of build/, so configure first (cmake --preset release).
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh clang-format-14 clang-tidy-14
cpp_files() { find "$@" \( -name '*.cpp' -o -name '*.hpp' \) -print0 | sort -z; }

if [ "${1:-}" = --format ]; then
  cpp_files apps bench include src tests | xargs -0 clang-format-14 -i
  exit 0
fi

cpp_files apps bench include src tests | xargs -0 clang-format-14 --dry-run --Werror ||
  { echo "Formatting differs; scripts/lint.sh --format writes it." >&2; exit 1; }

[ -f build/compile_commands.json ] || cmake --preset release > /dev/null
# One file a process: the costs of files differ widely. Warnings are GCC's to give (-w), also in builds with -Werror. clang-tidy counts the warnings of system headers on stderr.
find apps src -name '*.cpp' -print0 | sort -z |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy-14 -p build --quiet --extra-arg=-w 2> >(grep -vE '^[0-9]+ warnings? ' >&2) ||
  { echo "clang-tidy found something." >&2; exit 1; }
