#!/bin/sh
# Meshes a volume of ten million active voxels with less and less memory: tools/low_memory.sh [TUFA [LIMITS]]
#
# Every run must do its work, or end with exit code 3 and "out of memory" and leave nothing behind.
# TUFA is the command, by default that of the preset release; LIMITS the number of address spaces
# (ulimit -v) between 150 MB and 1.5 GB, 16 by default. Takes minutes.
set -eu
cd "$(dirname "$0")/.."
tufa=$(realpath "${1:-build/release/bin/tufa}")
limits=${2:-16}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

"$tufa" make sphere --voxel 0.00274 -o v.vdb --json >made.json
voxels=$(sed -n 's/.*"active_voxels": \([0-9]*\).*/\1/p' made.json)
rm made.json
echo "$voxels active voxels"
[ "$voxels" -ge 10000000 ]

broken=0
# attempt LIMIT OUTPUT ARGUMENT...: one run, its output and what it says judged.
attempt() {
  limit=$1
  output=$2
  shift 2
  code=0
  (ulimit -v "$limit" && exec "$tufa" "$@" -o "$output" --quiet) 2>errors || code=$?
  verdict=broken
  if [ "$code" = 0 ] && [ -e "$output" ]; then
    verdict=done
    rm -r "$output"
  elif [ "$code" = 3 ] && [ "$(cat errors)" = "tufa: out of memory" ]; then
    verdict="out of memory"
  else
    verdict="broken: $(cat errors)"
  fi
  rm errors
  if [ "$(ls -A)" != v.vdb ]; then
    verdict="broken: left $(ls -A)"
    find . -mindepth 1 ! -name v.vdb -delete
  fi
  case $verdict in broken*) broken=$((broken + 1)) ;; esac
  printf '%5d MB  %-38s exit code %3d: %s\n' $((limit / 1024)) "$*" "$code" "$verdict"
}

# sweep COUNT OUTPUT ARGUMENT...: with COUNT limits, evenly in their ratio.
sweep() {
  count=$1
  shift
  n=0
  while [ "$n" -lt "$count" ]; do
    attempt "$(awk -v n="$n" -v all="$count" \
      'BEGIN { printf "%d", 1024 * 150 * 10 ^ (n / (all > 1 ? all - 1 : 1)) }')" "$@"
    runs=$((runs + 1))
    n=$((n + 1))
  done
}

runs=0
sweep "$limits" u.ply mesh v.vdb --uniform
sweep "$limits" m.ply mesh v.vdb
# Longer ones.
sweep $(((limits + 3) / 4)) l.glb lod v.vdb --levels 2
sweep $(((limits + 3) / 4)) d chunks v.vdb --levels 2 --chunk 256
echo "$runs runs, $broken broke the promise"
[ "$broken" = 0 ]
