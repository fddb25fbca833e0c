#!/bin/sh
# Tries Tufa in a Debian that holds nothing else: a root made by debootstrap, thrown away at the end.
#
#   tools/clean-root.sh bookworm package FILE.deb...   installs the packages, makes and checks a mesh
#   tools/clean-root.sh trixie test [ARGUMENT...]   builds the last commit there and runs tools/test.sh
#
# Needs root and debootstrap. KEEP_ROOT=FOLDER keeps the root in FOLDER and takes it up again.
# MIRROR=URL names another mirror.
set -eu
cd "$(dirname "$0")/.."

usage() {
  sed -n '2,8s/^# \{0,1\}//p' "$0" >&2
  exit 2
}
[ $# -ge 2 ] || usage
release=$1
task=$2
shift 2

folder=${KEEP_ROOT:-$(mktemp -d)}
finish() {
  umount "$folder/proc" 2>/dev/null || true
  [ -n "${KEEP_ROOT:-}" ] || rm -rf --one-file-system "$folder"
}
trap finish EXIT
trap 'exit 130' INT TERM

[ -e "$folder/bin/sh" ] ||
  debootstrap --variant=minbase "$release" "$folder" "${MIRROR:-http://deb.debian.org/debian}"
cp /etc/resolv.conf "$folder/etc/resolv.conf"
mountpoint -q "$folder/proc" || mount -t proc proc "$folder/proc"
inside() { chroot "$folder" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }

case "$task" in
  package)
    [ -f "${1:-}" ] || usage
    mkdir -p "$folder/tmp/packages"
    cp "$@" "$folder/tmp/packages"
    inside apt-get update -q
    inside sh -c 'exec apt-get install -y -q --no-install-recommends /tmp/packages/*.deb'
    inside tufa make bracket --voxel 0.05 -o /tmp/bracket.vdb
    inside tufa mesh /tmp/bracket.vdb -o /tmp/bracket.glb --check
    inside tufa check /tmp/bracket.glb
    ;;
  test)
    rm -rf "$folder/src"
    mkdir "$folder/src"
    git archive HEAD | tar -x -C "$folder/src"
    inside apt-get update -q
    inside /src/tools/test.sh "$@"
    ;;
  *) usage ;;
esac
