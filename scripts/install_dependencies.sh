#!/usr/bin/env bash
# Installs what building needs and what is missing, with apt (Debian 12, Ubuntu 24.04).
# Usage: scripts/install_dependencies.sh [--tests] [PACKAGE...]   (--tests: also what building the tests needs; further packages)
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache pkg-config
  libode-dev libembree-dev libosmesa6-dev libpng-dev zlib1g-dev liblzf-dev
  libeigen3-dev libyaml-cpp-dev libcli11-dev nlohmann-json3-dev libfmt-dev libxxhash-dev libarchive-dev libsleef-dev libtbb-dev
  libboost-dev help2man
)
if [ "${1:-}" = --tests ]; then
  shift
  # PCL is compared with. Most of what is installed is what libpcl-dev asks for: VTK's headers, with a JDK, Qt and MPI,
  # which nothing here uses. Debian has PCL's headers in no other package.
  packages+=(libgtest-dev libgmock-dev libbenchmark-dev doxygen libpcl-dev)
fi
packages+=("$@")

command -v apt-get > /dev/null || { echo "$0: needs apt (Debian 12 or Ubuntu 24.04); install by other means: ${packages[*]}" >&2; exit 1; }

missing=()
for package in "${packages[@]}"; do
  dpkg-query --show --showformat='${db:Status-Status}' "$package" 2> /dev/null | grep -qx installed || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then exit 0; fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo > /dev/null || { echo "$0: run as root or install sudo; missing: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "Installing ${missing[*]}"
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
