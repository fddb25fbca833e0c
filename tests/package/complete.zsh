# complete.zsh COMPLETION: what the completion hands to zsh's own functions, which are stood in for.
_describe() { print -l -- ${(P)2} }
_arguments() { print -l -- "$@" }
words=(tufa me)
CURRENT=2
offered=$(. $1)
[[ $offered == *mesh:* ]] || { print "no subcommand mesh in $offered"; exit 1 }
words=(tufa mesh a)
CURRENT=3
offered=$(. $1)
for option in '*--ambiguity[' ':value:(asymptotic chord' '*:file:_files' '*--output['; do
  [[ $offered == *"$option"* ]] || { print "no $option in $offered"; exit 1 }
done
