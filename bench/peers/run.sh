#!/bin/sh
# Compares generate_dataset with PyBullet and MuJoCo: makes a virtual environment, installs both, and prints a Markdown
# table. Usage: bench/peers/run.sh --build BUILD [--cases N] [--jobs J] [--rounds R] [--seed S]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
venv=${TUBEBIN_PEERS_VENV:-$here/.venv}
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
"$venv/bin/pip" install --quiet --disable-pip-version-check --requirement "$here/requirements.txt"
exec "$venv/bin/python" "$here/compare.py" "$@"
