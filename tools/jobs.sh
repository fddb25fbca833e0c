#!/bin/sh
# Prints how many compilers to run at once: one a core, but no more than one for each 2 GB of memory.
set -eu
cores=$(nproc)
memory=$(awk '/^MemAvailable:/ { print int($2 / 2000000) }' /proc/meminfo)
if [ "$memory" -lt "$cores" ]; then cores=$memory; fi
if [ "$cores" -lt 1 ]; then cores=1; fi
echo "$cores"
