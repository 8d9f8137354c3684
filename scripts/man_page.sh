#!/usr/bin/env bash
# Prints the man page of a program, made by help2man from its --help.
# Usage: scripts/man_page.sh PROGRAM VERSION
set -euo pipefail
help2man --no-info --name="$("$1" --help | head -n 1)" --version-string="$2" --source="tubebin $2" "$1"
