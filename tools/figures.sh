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

# What the README says of sizes. The tolerances are the errors of volumeToMesh in docs/benchmarks.md.
"$tufa" make sphere --voxel 0.02 -o sphere.vdb --quiet
"$tufa" mesh sphere.vdb -o sphere.ply --tolerance 0.474 --json > out.json
figure README.md '| triangles within 0.474 voxel of a sphere, voxel 0.02 | 1,452 | ' ' |' \
  "$(grouped "$(key triangles)")"
"$tufa" make bracket --voxel 0.02 -o bracket.vdb --quiet
"$tufa" mesh bracket.vdb -o bracket.ply --tolerance 2.04 --json > out.json
figure README.md '| triangles within 2.04 voxels of the bracket, voxel 0.02 | 16,988 | ' ' |' \
  "$(grouped "$(key triangles)")"

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
