#!/bin/sh
# Builds the fuzz targets with clang, AddressSanitizer and UndefinedBehaviorSanitizer and runs each of
# them for some seconds: tools/fuzz.sh SECONDS [TARGET...]
#
# What they find new lies in build/fuzz/corpus, an input that breaks a promise in build/fuzz/broken.
set -eu
cd "$(dirname "$0")/.."

[ $# -ge 1 ] || {
  sed -n '2,5s/^# \{0,1\}//p' "$0" >&2
  exit 2
}
seconds=$1
shift
cmake --preset fuzz
cmake --build --preset fuzz --parallel "$(tools/jobs.sh)"

export LSAN_OPTIONS=suppressions=tests/lsan.supp:print_suppressions=0
[ $# -gt 0 ] || set -- $(ls tests/fuzz/corpus)

run() {
  found=build/fuzz/corpus/$1
  mkdir -p "$found" build/fuzz/broken
  log=build/fuzz/$1.log
  build/fuzz/bin/fuzz_"$1" -seed=1 -max_total_time="$seconds" -rss_limit_mb=4096 -timeout=60 \
    -print_final_stats=1 -artifact_prefix=build/fuzz/broken/"$1"- \
    "$found" tests/fuzz/corpus/"$1" >"$log" 2>&1 || {
    tail -n 40 "$log" >&2
    return 1
  }
  printf '%s: %s executions\n' "$1" "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")"
}

# As many targets at a time as there are cores.
failed=
while [ $# -gt 0 ]; do
  running=
  for _ in $(seq "$(nproc)"); do
    [ $# -gt 0 ] || break
    run "$1" &
    running="$running $!"
    shift
  done
  for target in $running; do wait "$target" || failed=1; done
  [ -z "$failed" ] || exit 1
done
