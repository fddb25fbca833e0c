#!/bin/sh
# From nothing to a picture: installs what is missing, builds the command, makes a demonstration
# volume, meshes it, checks the mesh with CGAL, and takes a picture of it.
# Writes to out/demo, or to the folder given as an argument.
set -eu
start=$(pwd)
cd "$(dirname "$0")/.."
out=out/demo
case "${1:-}" in
  "") ;;
  /*) out=$1 ;;
  *) out=$start/$1 ;;
esac
mkdir -p "$out"

tools/install-packages.sh
log=$out/build.log
echo "building (the first time takes some minutes; what is said goes to $log)"
if ! { cmake --preset release &&
  cmake --build --preset release --target tufa_command tufa_render \
    --parallel "$(tools/jobs.sh)"; } >"$log" 2>&1; then
  tail -n 40 "$log" >&2
  echo "$0: the build failed" >&2
  exit 1
fi

tufa=build/release/bin/tufa
$tufa make bracket -o "$out/bracket.vdb"
$tufa mesh "$out/bracket.vdb" -o "$out/bracket.ply" --check
build/release/bin/tufa_render -o "$out/bracket.png" "$out/bracket.ply:azimuth=60,elevation=50,edges=1"

cat <<END

wrote
  $out/bracket.vdb   the volume, a level set
  $out/bracket.ply   its mesh
  $out/bracket.png   a picture of the mesh
END
