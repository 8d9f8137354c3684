#!/usr/bin/env bash
# Prints a program's completion for bash, made from its --help: the long options, and after an option with a fixed set of
# values (a|b|c there) those. Everything else completes file names.
# Usage: scripts/bash_completion.sh PROGRAM
set -euo pipefail
name=$(basename "$1")
options=$("$1" --help | grep -oE '^  (-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+' | xargs)
values=$("$1" --help | sed -nE 's/^  ((-[a-z]),)?(--[a-z-]+) ([a-z_]+(\|[a-z_]+)+).*/\2 \3 \4/p')

echo "# bash completion of $name"
echo "_$name() {"
echo '  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} words='
echo '  case $before in'
while read -r keys_and_values; do
  [ -n "$keys_and_values" ] || continue
  set -- $keys_and_values
  alternatives="${*:1:$#-1}"
  echo "    ${alternatives// /|}) words='$(tr '|' ' ' <<< "${!#}")' ;;"
done <<< "$values"
echo "    *) [[ \$word != -* ]] || words='$options' ;;"
echo '  esac'
echo '  COMPREPLY=($(compgen -W "$words" -- "$word"))'
echo '}'
echo "complete -o default -F _$name $name"
