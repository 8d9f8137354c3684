#!/usr/bin/env bash
# Makes the Python environment of the tests (tests/requirements.txt) outside the source tree, where it is not there yet, and
# prints its folder. Fails where packages can't be fetched.
# Usage: scripts/python_environment.sh
set -euo pipefail
cd "$(dirname "$0")/.."
requirements=tests/requirements.txt
folder=${XDG_CACHE_HOME:-$HOME/.cache}/tubebin/python-$(sha256sum "$requirements" | cut -c 1-12)

if [ ! -e "$folder/complete" ]; then
  scripts/install_dependencies.sh python3-venv python3-dev >&2
  echo "Making the tests' Python environment in $folder (about a minute)" >&2
  rm -rf "$folder"
  python3 -m venv "$folder"
  "$folder/bin/pip" install --quiet --disable-pip-version-check --requirement "$requirements" >&2
  touch "$folder/complete"
fi
echo "$folder"
