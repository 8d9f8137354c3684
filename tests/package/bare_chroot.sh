#!/usr/bin/env bash
# The Debian package on a machine that has nothing: `cpack` makes it, a bare Debian 12 in a folder installs it with apt, and
# the programs in it make, model and evaluate a scene. Mounts are the test's own and gone with it.
# Usage: tests/package/bare_chroot.sh BUILD_DIR      exit code 77: not possible here, with the reason
set -euo pipefail
skip() {
  echo "skipped: $*"
  exit 77
}
[ "$(id -u)" -eq 0 ] || skip "a chroot needs root"
for program in debootstrap unshare chroot dpkg-shlibdeps; do
  command -v "$program" > /dev/null || skip "$program is not installed (Debian: debootstrap util-linux dpkg-dev)"
done
grep -q '^VERSION_CODENAME=bookworm' /etc/os-release || skip "the package is for the release that it is built on, here not Debian 12"
unshare --mount true 2> /dev/null || skip "this root may not mount"

if [ "${2:-}" != inside ]; then
  exec unshare --mount --propagation private "$0" "$1" inside
fi
build=$(realpath "$1")
work=$(mktemp -d /tmp/tubebin_chroot_XXXXXX)
finish() {
  umount "$work/root/proc" 2> /dev/null || true
  rm -rf --one-file-system "$work"
}
trap finish EXIT

(cd "$build" && cpack -B "$work/packages") > "$work/cpack.log" || { cat "$work/cpack.log" >&2; exit 1; }
# Only what the network lacks is a reason to skip.
debootstrap --variant=minbase bookworm "$work/root" > "$work/debootstrap.log" 2>&1 || {
  grep -qE 'Failed getting release file|Couldn.t download' "$work/debootstrap.log" && skip "no Debian mirror can be reached"
  tail "$work/debootstrap.log" >&2
  exit 1
}
mount -t proc proc "$work/root/proc"
cp "$work"/packages/tubebin_*.deb "$work/root/tmp/"

in_root() { chroot "$work/root" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive "$@"; }
# As Debian's vim does it.
in_root sh -c 'printf "#!/bin/sh\necho editor\n" > /usr/bin/editor-view && chmod +x /usr/bin/editor-view &&
               update-alternatives --install /usr/bin/view view /usr/bin/editor-view 15' > /dev/null
in_root sh -c 'apt-get update && apt-get install -y --no-install-recommends /tmp/tubebin_*.deb' > "$work/apt.log" 2>&1 ||
  { tail "$work/apt.log" >&2; exit 1; }

in_root sh -euc '
cd /tmp
generate_dataset /usr/share/tubebin/config/set_a.yaml --output data --tubes 5 --cases 1 --quiet
model_tubes data/A5/001/cloud.pcd --output one
evaluate --filtered one/filtered.pcd --labeled one/labeled.pcd' | tee "$work/log"
awk '/^micro-recall/ && $2 > 0.95 && $2 <= 1 {good = 1} END {exit !good}' "$work/log" ||
  { echo "FAILED: the tubes were not found" >&2; exit 1; }

views() {  # EXPECTED PROGRAM: what the program prints begins so
  [[ $(in_root "$2" --version) == "$1"* ]] || { echo "FAILED: $2 is not the $1's" >&2; exit 1; }
}
views editor view
views tubebin tubebin-view
in_root update-alternatives --remove view /usr/bin/editor-view > /dev/null
views tubebin view
in_root apt-get remove -y tubebin > /dev/null 2>&1
[ ! -L "$work/root/usr/bin/view" ] || { echo "FAILED: view points to what is gone" >&2; exit 1; }
