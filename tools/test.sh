#!/bin/sh
# Installs what is missing, builds the release preset and runs every test.
# Arguments go to ctest: tools/test.sh -R Mesh
set -eu
cd "$(dirname "$0")/.."

tools/install-packages.sh
jobs=$(tools/jobs.sh)
cmake --preset release
cmake --build --preset release --parallel "$jobs"
ctest --preset release --parallel "$(nproc)" "$@"
