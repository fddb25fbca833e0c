#!/bin/sh
# Prints a digest of every mesh, chain and chunk that a command makes of some volumes. Two builds give
# the same results if their lists are equal:
#   tools/digests.sh old/bin/tufa *.vdb >old.txt; tools/digests.sh new/bin/tufa *.vdb | diff old.txt -
# Volumes whose name ends in .fast.vdb are meshed, but not made into chunks.
set -eu
[ $# -ge 2 ] || {
  echo "usage: $0 COMMAND VOLUME.vdb..." >&2
  exit 2
}
tufa=$1
shift
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# digest LABEL ARGUMENTS...: runs the command with these arguments in an empty folder, and prints one
# digest for all files that it leaves there. The certified error and other figures count, times do not.
digest() {
  label=$1
  shift
  rm -rf "$scratch/out"
  mkdir "$scratch/out"
  if "$@" --quiet >"$scratch/log" 2>&1; then
    sum=$(cd "$scratch/out" && find . -type f | LC_ALL=C sort | xargs -r sha256sum | sha256sum | cut -c 1-16)
  else
    sum="exit $?"
  fi
  printf '%s %s\n' "$sum" "$label"
}

for volume in "$@"; do
  name=$(basename "$volume" .vdb)
  out=$scratch/out/m
  digest "$name uniform" "$tufa" mesh "$volume" -o "$out.ply" --uniform
  digest "$name cut" "$tufa" mesh "$volume" -o "$out.ply" --no-simplify
  digest "$name 0.1" "$tufa" mesh "$volume" -o "$out.ply"
  digest "$name 0.5 one thread" "$tufa" mesh "$volume" -o "$out.ply" --tolerance 0.5 --threads 1
  digest "$name 2 capped" "$tufa" mesh "$volume" -o "$out.ply" --tolerance 2 --cap --ambiguity asymptotic
  digest "$name chain" "$tufa" lod "$volume" -o "$out.glb" --levels 4
  case $name in
    *.fast) ;;
    *) digest "$name chunks" "$tufa" chunks "$volume" -o "$out" --chunk 32 --levels 3 ;;
  esac
done
