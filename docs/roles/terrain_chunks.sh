#!/bin/sh
# From a large volume to chunks that an engine streams: see terrain_chunks.md. The folder of the
# commands is the first argument; everything is written to the current folder.
set -eu
PATH=$1:$PATH

tufa make terrain --voxel 0.025 -o terrain.vdb
tufa chunks terrain.vdb -o terrain --chunk 32 --levels 4 --up z --compress

# What a camera sees: each chunk at the LOD whose error is below four pixels, without cracks.
tufa chunks --assemble terrain --lods camera:0.3,-2.5,1 --pixel-error 4 -o seen.ply --check

# A chunk whose files were lost: it alone is written anew, of the same volume with the same options. If
# the volume has changed, all chunks have to be written again.
rm terrain/chunk_0_0_0_LOD*.glb
tufa chunks terrain.vdb -o terrain --chunk 32 --levels 4 --up z --compress --only 0,0,0

tufa_render -o terrain_chunks.png --size 380x330 \
  terrain:azimuth=-60,elevation=45,eyex=0.3,eyey=-2.5,eyez=1,step=1 \
  seen.ply:azimuth=-60,elevation=45,edges=1
