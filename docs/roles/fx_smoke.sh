#!/bin/sh
# From frames of smoke to meshes with temperature and motion: see fx_smoke.md. The folder of the
# commands is the first argument; everything is written to the current folder.
set -eu
PATH=$1:$PATH

example_smoke frames 9
tufa info frames/smoke.0005.vdb

# One isovalue for all frames. Frame 1 is empty still, and is written empty.
tufa mesh 'frames/smoke.####.vdb' -o 'smoke.####.glb' --iso 0.15 --tolerance 0.3 --jobs 2 \
  --attribute temperature --velocity vel --shutter 1/48 --up z --report smoke.csv

# A later run leaves out what is newer than its volume: here, all but frame 5.
touch frames/smoke.0005.vdb
tufa mesh 'frames/smoke.####.vdb' -o 'smoke.####.glb' --iso 0.15 --tolerance 0.3 --jobs 2 \
  --attribute temperature --velocity vel --shutter 1/48 --up z --resume

# For Houdini, Blender and usdview, a prim a frame.
tufa mesh 'frames/smoke.####.vdb' -o 'smoke.####.usda' --iso 0.15 --tolerance 0.3 --jobs 2 \
  --attribute temperature --up z --frames 2-9 --quiet

tufa_render -o fx_smoke.png --size 250x250 smoke.0003.glb:yup=1,azimuth=30,elevation=10 \
  smoke.0005.glb:yup=1,azimuth=30,elevation=10,edges=1 \
  smoke.0009.glb:yup=1,azimuth=30,elevation=10
