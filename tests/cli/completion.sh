#!/usr/bin/env bash
# Completion as the shells do it: completion.sh COLLIDE. Shells that are not installed are named and left out.
set -euo pipefail
collide=$1
PATH=$(dirname "$collide"):$PATH
fail() { echo "completion: $*" >&2; exit 1; }

found=$(bash --norc -c 'source <(collide completion bash); COMP_WORDS=(collide ra); COMP_CWORD=1; _collide
  echo "${COMPREPLY[*]}"; COMP_WORDS=(collide ray --onl); COMP_CWORD=2; _collide; echo "${COMPREPLY[*]}"')
[[ $found == $'ray\n--only' ]] || fail "bash found '$found'"
if command -v zsh >/dev/null; then
  zsh -f -c 'autoload -U compinit; compinit -D -u; source <(collide completion zsh); [[ -n ${_comps[collide]} ]]' ||
    fail "zsh does not take it"
else
  echo "zsh is not installed: left out"
fi
if command -v fish >/dev/null; then
  fish --no-config -c 'collide completion fish | source; complete -C "collide ra"' | grep -q '^ray' || fail "fish finds no verb"
else
  echo "fish is not installed: left out"
fi
