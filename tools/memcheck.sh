#!/bin/sh
# Runs a part of the tests of the release build under valgrind: every stage on small grids, all
# readers and writers, and what the fuzz targets found. Takes minutes.
set -eu
cd "$(dirname "$0")/../build/release"

check() {
  echo "$*"
  # Memory that OpenVDB, TBB and blosc keep to the end of the process is no leak of Tufa's.
  valgrind --quiet --error-exitcode=9 --leak-check=full --show-leak-kinds=definite \
    --errors-for-leak-kinds=definite --fair-sched=yes "$@" >memcheck.log 2>&1 || {
    tail -n 60 memcheck.log >&2
    exit 1
  }
}

corpus=../../tests/fuzz/corpus
for folder in "$corpus"/read_*; do
  check bin/fuzz_"${folder##*/}" "$folder"
done
check bin/fuzz_contour "$corpus"/contour
check bin/stages_test --gtest_filter="Blocks*:Isovalue*:Ambiguity*:CaseTable*:Crease*:Crossings*:Qef*:PlaceVertices*"
check bin/io_test
check bin/reduce_test
# Files damaged in thousands of ways are for the sanitizers, which are quicker.
check bin/chunk_parts_test --gtest_filter="-*SurviveDamage*:*SurvivesDamage*:*EndTooEarly*"
