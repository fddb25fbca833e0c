#!/bin/sh
# Writes the tables of docs/which-method.md: every method on four volumes, which takes minutes. Processor
# times are those of this machine.
#
#   tools/methods_tables.sh PROGRAM DATA     PROGRAM: tufa_methods_table of the preset "bench"
#                                            DATA: the folder of sample files
set -eu

program=$(realpath "${1:?the program tufa_methods_table}")
data=$(realpath "${2:?the folder of sample files}")
page=$(cd "$(dirname "$0")/.." && pwd)/docs/which-method.md
new=$(mktemp)
trap 'rm -f "$new"' EXIT

[ -f "$data/headsq_ct.mhd" ] || {
  echo "$data/headsq_ct.mhd is missing: the tables would be without the CT head" >&2
  exit 2
}
# What stands before the first table, and the tables after it.
awk '/^### / { exit } { lines[NR] = $0 }
  END { while (NR > 0 && lines[NR] == "") --NR; for (i = 1; i <= NR; ++i) print lines[i] }' \
  "$page" > "$new"
"$program" "$data" >> "$new"
cat "$new" > "$page"
