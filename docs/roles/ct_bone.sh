#!/bin/sh
# From a CT scan to a bone that a printer takes: see ct_bone.md. The folder of the commands is the
# first argument, the folder of the sample data may be the second; everything is written to the
# current folder.
set -eu
PATH=$1:$PATH

if [ -f "${2:-}/headsq_ct.raw" ]; then
  # A head of 64 x 64 x 93 voxels; a folder with a DICOM series needs neither size nor type.
  tufa import "$2/headsq_ct.raw" -o scan.vdb --size 64,64,93 --type u16 --spacing 3.2,3.2,1.5 \
    --threshold 100
  iso=1150
else
  # Without the head: two shapes in a fog, one of them dust.
  tufa model "$(dirname "$0")/phantom.json" -o scan.vdb --fog
  iso=0.1
fi
tufa info scan.vdb

# Smooth the noise, keep the largest piece of bone, and leave nothing open.
tufa mesh scan.vdb -o bone.ply --iso $iso --smooth gaussian --keep-largest 1 --tolerance 0.2 --check

# A world unit of the scan is a millimetre. The slices of the head run from crown to chin: z points down
# in it, and the bone stands on its crown until it is turned in the program that slices it.
if tufa mesh scan.vdb -o bone.3mf --iso $iso --smooth gaussian --keep-largest 1 --tolerance 0.2 \
  --scale 0.001 --up z 2> no_3mf.txt; then
  echo "bone.3mf is in millimetres"
else
  grep -q lib3mf no_3mf.txt
  tufa mesh scan.vdb -o bone.stl --iso $iso --smooth gaussian --keep-largest 1 --tolerance 0.2
fi

# An elevation beyond 90 degrees turns the camera over, and so the head upright.
tufa_render -o ct_bone.png --size 300x320 bone.ply:azimuth=120,elevation=170 \
  bone.ply:azimuth=120,elevation=170,edges=1
