# Completion of xdrgen's command line, for bash.
_xdrgen() {
    local word=${COMP_WORDS[COMP_CWORD]} option=
    # "--lang=c" comes as three words.
    if [[ $word == = ]]; then
        option=${COMP_WORDS[COMP_CWORD - 1]}
        word=
    elif [[ ${COMP_WORDS[COMP_CWORD - 1]} == = ]]; then
        option=${COMP_WORDS[COMP_CWORD - 2]}
    fi
    local words=
    case $option in
    --lang) words="c c++ python json" ;;
    --directives) words="portable gcc none" ;;
    '') [[ $word != -* ]] || words="-h --help --version --lang= --register --directives= -D -I
                                    -v --verbose -n --no-header --spec --formats" ;;
    esac
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
    [[ ${COMPREPLY[*]} != *= ]] || compopt -o nospace 2>/dev/null
}
complete -o default -F _xdrgen xdrgen
