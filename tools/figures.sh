#!/bin/sh
# Compares figures in the documents with what the command prints, and says which differ; exit code 1 if
# any does. With --write puts the right ones in. A figure of a mesh that is not at hand is left out.
#
#   tools/figures.sh [--write] TUFA [DATA]     DATA: the folder of sample files
set -eu

write=no
if [ "${1:-}" = --write ]; then
  write=yes
  shift
fi
tufa=$(realpath "${1:?the command}")
data=${2:-}
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
wrong=0
compared=0

# key NAME: the first number of that name in the JSON of the last run.
key() { sed -n "s/.*\"$1\": \([0-9.e+-]*\),\{0,1\}\$/\1/p" out.json | head -n 1; }

# grouped NUMBER: with a comma every three digits.
grouped() { echo "$1" | sed -e :a -e 's/\([0-9]\)\([0-9]\{3\}\)\($\|,\)/\1,\2\3/;ta'; }

# figure FILE BEFORE AFTER VALUE: between the texts BEFORE and AFTER, on one line of FILE, stands VALUE.
figure() {
  file=$root/$1
  found=$(awk -v before="$2" -v after="$3" '
    (i = index($0, before)) > 0 {
      rest = substr($0, i + length(before))
      if ((j = index(rest, after)) > 0) { print substr(rest, 1, j - 1); exit }
    }' "$file")
  compared=$((compared + 1))
  [ "$found" != "$4" ] || return 0
  if [ -z "$found" ]; then
    echo "$1: nothing stands between \"$2\" and \"$3\"" >&2
    exit 2
  fi
  wrong=$((wrong + 1))
  echo "$1: \"$2$found\" should be \"$2$4\""
  [ "$write" = yes ] || return 0
  awk -v before="$2" -v after="$3" -v value="$4" '
    !done && (i = index($0, before)) > 0 {
      rest = substr($0, i + length(before))
      if ((j = index(rest, after)) > 0) {
        $0 = substr($0, 1, i - 1) before value substr(rest, j)
        done = 1
      }
    }
    { print }' "$file" > new
  cat new > "$file"
}

# error VOLUME METHOD: the largest distance of its mesh to the trilinear surface, both ways.
error() {
  "$tufa" compare "$1" --methods "$2" --json > out.json
  sed -n 's/.*"largest": \([0-9.e+-]*\),\{0,1\}$/\1/p' out.json | sort -g | tail -n 1
}

# What the README says of sizes: triangles at the error of volumeToMesh, as tufa_error_table, whose rows
# docs/benchmarks.md has, chooses the tolerance.
for shape in sphere bracket; do
  "$tufa" make $shape --voxel 0.02 -o $shape.vdb --quiet
  own=$(error $shape.vdb dual-uniform)
  theirs=$(error $shape.vdb volume-to-mesh-0.25)
  triangles=$(grouped "$(key triangles)")
  within=$(awk -v error="$theirs" 'BEGIN { printf "%.3g", error }')
  tolerance=$(awk -v error="$theirs" -v own="$own" \
    'BEGIN { t = error - own; printf "%.17g", (t > 0.05 ? t : 0.05) }')
  "$tufa" mesh $shape.vdb -o $shape.ply --tolerance "$tolerance" --json > out.json
  figure README.md '| triangles within ' " voxel of the $shape, voxel 0.02 | " "$within"
  row="| triangles within $within voxel of the $shape, voxel 0.02 | "
  figure README.md "$row" ' | ' "$triangles"
  figure README.md "$row$triangles | " ' |' "$(grouped "$(key triangles)")"
done

# How far both are from the true bracket.
"$tufa" make bracket --voxel 0.03 -o coarse.vdb --quiet
from_truth() {
  "$tufa" compare coarse.vdb --truth bracket --methods "$1" --json > out.json
  awk '/"mesh_to_truth"/ { on = 1 } on && /"largest"/ { l = $2 + 0 } on && /"mean"/ { m = $2 + 0; on = 0 }
    END { printf "%.2f, %.2g voxel", l, m }' out.json
}
row='| largest, mean distance to the true bracket, uniform mesh, voxel 0.03 | '
theirs=$(from_truth volume-to-mesh-0)
figure README.md "$row" ' | ' "$theirs"
figure README.md "$row$theirs | " ' |' "$(from_truth dual-uniform)"

# Methods compared: what does not depend on the machine.
for method in mc emc surface-nets; do
  "$tufa" compare bracket.vdb --methods $method --truth bracket --json > out.json
  faults=none
  pairs=$(grouped "$(key self_intersecting_pairs)")
  page=docs/which-method.md
  row="| bracket, $method | "
  figure $page "$row" " | $faults | " "$(grouped "$(key triangles)")"
  figure $page "$row$(grouped "$(key triangles)") | $faults | " ' | ' "$pairs"
  figure $page "$row$(grouped "$(key triangles)") | $faults | $pairs | " ' | ' \
    "$(sed -n 's/.*"euler_characteristic": \([0-9-]*\),$/\1/p' out.json | head -n 1)"
done

# Spot, at 0.01 units a voxel as docs/index.md has it.
spot=$data/ode_spot.obj
if [ -n "$data" ] && [ -f "$spot" ]; then
  "$tufa" voxelize "$spot" --voxel 0.01 -o spot.vdb --quiet
  "$tufa" lod spot.vdb -o spot.glb --json > out.json
  figure docs/lod.md '*Spot, ' ' active voxels' "$(grouped "$(key active_voxels)")"
  coverage=$(sed -n 's/.*"screen_coverage": \([0-9.e+-]*\),\{0,1\}$/\1/p' out.json |
    awk '{ printf "%s%.3g", (NR > 1 ? ", " : ""), $1 }')
  figure docs/lod.md '"MSFT_screencoverage": [' ']' "$coverage"
else
  echo "no sample files: the figures of Spot are left out" >&2
fi

echo "$compared figures compared, $wrong of them wrong" >&2
[ "$wrong" -eq 0 ] || [ "$write" = yes ]
