#!/bin/sh
# Installs the Debian packages (12 and 13) that the build and the tests need, and only those that are
# missing. With the argument "gate" also what .ci/run needs, with "package" what packages are made and
# looked at with, and what the command can do without, but packages have: ITK, by which `tufa import`
# reads images, NanoVDB, whose files it reads, Ceres Solver, by which `tufa fit` fits blobs, and on
# Debian 12 lib3mf, by which it writes .3mf. Asks for root through sudo if need be.
set -eu

packages="ca-certificates cmake g++ git ninja-build
  libopenvdb-dev libtbb-dev libimath-dev libmeshoptimizer-dev
  libcgal-dev libgmp-dev libmpfr-dev libboost-dev
  libcli11-dev nlohmann-json3-dev libpng-dev libgtest-dev"
case "${1:-}" in
  "") ;;
  gate) packages="$packages clang clang-format doxygen libclang-rt-dev libceres-dev" ;;
  package)
    packages="$packages dpkg-dev lintian libinsighttoolkit5-dev libnanovdb-dev libblosc-dev zlib1g-dev libceres-dev"
    # Later ones have lib3mf 2, whose interface is another one.
    if grep -qs '^12' /etc/debian_version; then packages="$packages lib3mf-dev"; fi
    ;;
  *)
    echo "usage: $0 [gate|package]" >&2
    exit 2
    ;;
esac

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "$0: no Debian here; install by other means: $packages" >&2
  exit 0
fi

missing=""
for package in $packages; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

echo "installing:$missing" >&2
root=""
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || {
    echo "$0: needs root, or sudo, to install these packages" >&2
    exit 1
  }
  root="sudo"
fi
# Package lists of a fresh machine are old or absent.
$root apt-get update -q
# shellcheck disable=SC2086 # a list of words
$root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing
