#!/usr/bin/env bash
# The Python package as a user gets it: the wheel is built, made to carry its libraries, installed into an environment that
# has numpy alone, and used there. Then python/tests and mypy run on it, and what needs PyTorch where Debian's is installed.
# A build with TUBEBIN_PYTHON has compiled the wheel's module already; beside another one it is compiled from nothing.
# Skips (77) where the tools or numpy can't be had.
# Usage: tests/package/python_wheel.sh BUILD_DIR
set -euo pipefail
source=$(realpath "$(dirname "$0")/../..")
build=$(realpath "$1")
python3 -c 'import auditwheel, mypy, nanobind, pytest, scikit_build_core' ||
  { echo "skipped: python3 lacks a package (tests/requirements.txt)"; exit 77; }
work=$(mktemp -d /tmp/tubebin_wheel_XXXXXX)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/bare"
"$work/bare/bin/pip" install --quiet --disable-pip-version-check --retries 1 numpy 2> "$work/log" ||
  { echo "skipped: numpy can't be fetched: $(tail -1 "$work/log")"; exit 77; }

export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
compiled=(-C build-dir="$build/python-wheel")
prefix=
if grep -q '^TUBEBIN_PYTHON:BOOL=ON' "$build/CMakeCache.txt"; then
  compiled=(-C build-dir="$build" -C cmake.define.TUBEBIN_TESTS=ON)
  prefix=$(sed -n 's/^CMAKE_INSTALL_PREFIX:PATH=//p' "$build/CMakeCache.txt")
fi
python3 -m pip wheel --disable-pip-version-check --no-build-isolation --no-deps "${compiled[@]}" \
  --wheel-dir "$work" "$source" > "$work/log" 2>&1 || { cat "$work/log"; exit 1; }
# The wheel's folder took the prefix' place.
[ -z "$prefix" ] || cmake -DCMAKE_INSTALL_PREFIX="$prefix" "$build" > "$work/log"
python3 -m auditwheel repair --wheel-dir "$work/repaired" "$work"/tubebin-*.whl 2> "$work/log" ||
  { cat "$work/log"; exit 1; }
wheel=$(echo "$work"/repaired/tubebin-*.whl)
megabytes=$(($(stat -c %s "$wheel") / 1000000))
echo "$(basename "$wheel"): $megabytes MB, $(($(stat -c %s "$work"/tubebin-*.whl) / 1000)) kB without libraries"
[ "$megabytes" -le 40 ] || { echo "docs/python.md says 35 MB"; exit 1; }

"$work/bare/bin/pip" install --quiet --disable-pip-version-check --no-index "$wheel"
cd "$work"
"$work/bare/bin/python" - << 'END'
import re
import tubebin

cloud = tubebin.generate({}, tubes=2).scan()
model = tubebin.model(cloud.points, cloud.viewpoint)
assert tubebin.evaluate(cloud.labels, model.labels).micro_recall > 0.95
loaded = re.findall(r"/usr/lib.*/(lib(?:embree|ode|pcl|archive|yaml|fmt|sleef|tbb).*)", open("/proc/self/maps").read())
assert not loaded, f"of the system, not of the wheel: {set(loaded)}"
END

# From here on the tools of the tests are there, too.
python3 -c 'import site; print(site.getsitepackages()[0])' > "$(echo "$work"/bare/lib/python3*/site-packages)/tools.pth"
cp "$source/pyproject.toml" .
cp -r "$source/python/tests" .
"$work/bare/bin/python" -m mypy -p tubebin
MYPYPATH=tests "$work/bare/bin/python" -m mypy tests
TUBEBIN_PROGRAMS=$build/bin TUBEBIN_SOURCE=$source "$work/bare/bin/python" -m pytest --quiet -p no:cacheprovider tests

# PyTorch from the package index comes with gigabytes for graphics cards, Debian's (python3-torch) without, beside Debian's numpy.
if ! /usr/bin/python3 -c 'import torch' 2> "$work/log"; then
  echo "without PyTorch, whose tests are left out: $(tail -1 "$work/log")"
  exit
fi
/usr/bin/python3 -m venv --system-site-packages "$work/torch"
"$work/torch/bin/pip" install --quiet --disable-pip-version-check "$wheel" "$(grep ^pytest== "$source/tests/requirements.txt")"
TUBEBIN_PROGRAMS=$build/bin TUBEBIN_SOURCE=$source "$work/torch/bin/python" -m pytest --quiet -p no:cacheprovider -k torch tests
