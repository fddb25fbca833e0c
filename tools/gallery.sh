#!/bin/sh
# Makes the pictures of docs/gallery.md from docs/examples/scenes, with voxels half as long as the
# scenes say:
#
#     tools/gallery.sh [build/release/bin]
set -eu
cd "$(dirname "$0")/.."
bin=$(realpath "${1:-build/release/bin}")
out=$PWD/docs/pictures
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for scene in docs/examples/scenes/*.json; do
  name=$(basename "$scene" .json)
  voxel=$(sed -n 's/.*"voxel": *\([0-9.]*\).*/\1/p' "$scene")
  half=$(awk "BEGIN { print $voxel / 2 }")
  "$bin/tufa" model "$scene" -o "$work/$name.vdb" --voxel "$half" --quiet
  "$bin/tufa" mesh "$work/$name.vdb" -o "$work/$name.ply" --tolerance 0.05 --quiet
done

cd "$work"
"$bin/tufa_render" -o "$out/gallery_distances.png" --size 330x290 \
  primitives.ply:azimuth=80,elevation=40 csg.ply:azimuth=30,elevation=25 \
  smooth.ply:azimuth=30,elevation=25
"$bin/tufa_render" -o "$out/gallery_surfaces.png" --size 330x290 \
  repetition.ply:azimuth=30,elevation=20 quadrics.ply:azimuth=80,elevation=40 \
  gyroid.ply:azimuth=30,elevation=20
"$bin/tufa_render" -o "$out/gallery_equations.png" --size 330x290 \
  lattices.ply:azimuth=70,elevation=20 torus.ply:azimuth=30,elevation=35 \
  heart.ply:azimuth=-60,elevation=10
"$bin/tufa_render" -o "$out/gallery_algebraic.png" --size 330x290 \
  clebsch.ply:azimuth=30,elevation=20 barth.ply:azimuth=20,elevation=20 \
  metaballs.ply:azimuth=-60,elevation=15
"$bin/tufa_render" -o "$out/gallery_meshes.png" --size 900x420 meshes.ply:azimuth=35,elevation=20
"$bin/tufa_render" -o "$out/gallery_skeletons.png" --size 330x290 \
  particles.ply:azimuth=30,elevation=20 convolution.ply:azimuth=-70,elevation=15 \
  sails.ply:azimuth=-60,elevation=15
