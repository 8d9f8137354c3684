#!/usr/bin/env bash
# `cmake --install` into a folder: the man pages can be read, the completions complete, and examples/cpp finds the package,
# builds and runs.
# Usage: tests/package/installed.sh BUILD_DIR
set -euo pipefail
source=$(realpath "$(dirname "$0")/../..")
work=$(mktemp -d /tmp/tubebin_install_XXXXXX)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $*" >&2
  exit 1
}
cmake --install "$1" --prefix "$work/usr" > "$work/install.log"

check_help() {  # PROGRAM
  local page=$work/usr/share/man/man1/$1.1
  "$work/usr/bin/$1" --version > /dev/null || fail "$1 --version"
  if command -v help2man > /dev/null; then
    grep -q -- '\\-\\-version' "$page" || fail "$page names no options"
  fi
}

completes() {  # "WORD WORD..." EXPECTED...: pressing tab after the words offers exactly these
  read -ra words <<< "$1"
  [[ $1 != *" " ]] || words+=("")
  local offered
  offered=$(bash -c 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); "_$1"; echo "${COMPREPLY[*]}"' _ \
    "$work/usr/share/bash-completion/completions/${words[0]}" "${words[@]}")
  [ "$offered" = "${*:2}" ] || fail "'$1' completes to '$offered', not '${*:2}'"
}

for program in generate_dataset model_tubes calibrate_modeler export_dataset evaluate view; do check_help "$program"; done
completes "model_tubes cloud.pcd --rat" --ratio --ratios
completes "model_tubes cloud.pcd --method " centerline region_growing both
completes "export_dataset -f c" coco
completes "generate_dataset config" ""  # a file name, which bash completes itself

cmake -S "$source/examples/cpp" -B "$work/examples" -DCMAKE_PREFIX_PATH="$work/usr" -DCMAKE_BUILD_TYPE=Release > "$work/configure.log"
grep -q "tubebin_DIR:PATH=$work" "$work/examples/CMakeCache.txt" || fail "the examples found another package"
cmake --build "$work/examples" --parallel 2 > "$work/build.log" || { cat "$work/build.log" >&2; fail "the examples do not build"; }
mkdir "$work/run"
cd "$work/run"
for program in 1_generate_scene 2_scan_scene 3_model_tubes; do "$work/examples/$program" > log || fail "$program"; done
"$work/examples/4_score_labels" | tee log
awk '/^micro-recall/ && $2 > 0.95 && $2 <= 1 {good = 1} END {exit !good}' log || fail "the examples' tubes were not found"
