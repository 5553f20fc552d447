# Completion of killCentral's command line, for bash.
_killCentral() {
    local word=${COMP_WORDS[COMP_CWORD]}
    COMPREPLY=()
    if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "-h --help" -- "$word")
    elif [[ $COMP_CWORD == 1 ]]; then
        mapfile -t COMPREPLY < <(compgen -A hostname -- "$word")
    fi
}
complete -F _killCentral killCentral
