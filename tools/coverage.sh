#!/bin/sh
# Builds the preset coverage, runs the tests and prints the share of the library's lines that they
# reach, file by file. Needs gcovr. Arguments go to ctest.
set -eu
cd "$(dirname "$0")/.."

cmake --preset coverage
cmake --build --preset coverage --parallel "$(tools/jobs.sh)"
find build/coverage -name '*.gcda' -delete
# What happens in tests that fail is reached all the same.
ctest --preset coverage --parallel "$(nproc)" "$@" || echo "some tests failed" >&2
gcovr --root . --filter 'lib/' --object-directory build/coverage --exclude-throw-branches \
  --print-summary
