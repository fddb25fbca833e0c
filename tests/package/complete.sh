# What bash offers for the last of the words: complete.sh COMPLETION WORD...
. "$1"
shift
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
_tufa
echo "${COMPREPLY[@]}"
