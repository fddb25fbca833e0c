#!/bin/sh
# Measures a build from nothing, without ccache: tools/build_time.sh [TARGET...]
#
# Prints the seconds of processor time that the preset release takes, in all and for each of the ten
# slowest units of sources: time on the clock says little on a machine that does other work too. Without a target
# everything is built, tests included.
set -eu
cd "$(dirname "$0")/.."
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Runs its arguments, a compiler with its own, and logs the processor time and what was made.
cat >"$scratch/timed" <<'END'
#!/bin/sh
"$@" || exit
made=total
for argument; do
  if [ "$made" = next ]; then made=$argument; fi
  if [ "$argument" = -o ]; then made=next; fi
done
# Not through a pipe, whose shell has run nothing. The second line is for what was run: "0m1.2s 0m0.1s".
times >"$TUFA_BUILD_TIMES.$$"
awk -v made="$made" 'NR == 2 {
  split($0, part, /[ms ]+/)
  printf "%7.1f  %s\n", 60 * (part[1] + part[3]) + part[2] + part[4], made
}' "$TUFA_BUILD_TIMES.$$" >>"$TUFA_BUILD_TIMES"
END
chmod +x "$scratch/timed"
export TUFA_BUILD_TIMES="$scratch/times"

cmake --preset release -B "$scratch/build" -DCMAKE_CXX_COMPILER_LAUNCHER="$scratch/timed" >"$scratch/log"
[ $# -eq 0 ] || set -- --target "$@"
start=$(date +%s)
"$scratch/timed" cmake --build "$scratch/build" --parallel "$(tools/jobs.sh)" "$@" >"$scratch/log" || {
  tail -n 40 "$scratch/log" >&2
  exit 1
}
echo "$(($(date +%s) - start)) s on the clock; processor time in seconds:"
sort -rn "$TUFA_BUILD_TIMES" | head -n 11
