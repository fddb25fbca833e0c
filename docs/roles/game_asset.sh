#!/bin/sh
# From a volume to the LODs of a game's asset: see game_asset.md. The folder of the commands is the
# first argument; everything is written to the current folder.
set -eu
PATH=$1:$PATH

tufa make bracket --voxel 0.02 -o bracket.vdb

# One file with all LODs, small, for three.js, Babylon and engines that know MSFT_lod.
tufa lod bracket.vdb -o bracket.glb --levels 4 --up z --scale 0.01 --compress

# A file for each LOD, for Blender and for engines that take one mesh a file.
tufa lod bracket.vdb -o bracket.glb --levels 4 --up z --scale 0.01 --separate --check

# A budget of triangles in place of tolerances.
tufa lod bracket.vdb -o 'budget_{}.glb' --triangles 800,300,120 --up z --scale 0.01

tufa_render -o game_asset.png --size 250x230 \
  bracket_LOD0.glb:yup=1,azimuth=60,elevation=40,edges=1 \
  bracket_LOD1.glb:yup=1,azimuth=60,elevation=40,edges=1 \
  bracket_LOD2.glb:yup=1,azimuth=60,elevation=40,edges=1
