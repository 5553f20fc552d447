# Completion of killModule's command line, for bash.
_killModule() {
    local word=${COMP_WORDS[COMP_CWORD]}
    COMPREPLY=()
    if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "-h --help" -- "$word")
    elif [[ $COMP_CWORD == 2 ]]; then
        mapfile -t COMPREPLY < <(compgen -A hostname -- "$word")
    fi
}
complete -F _killModule killModule
