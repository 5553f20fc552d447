# Completion of central's command line, for bash.  The options are written down here: another
# server of that name, asked for its help, might start instead.
_central() {
    local word=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD - 1]}
    # "--bind=local" comes as three words; "--bind local" is the same.
    if [[ $word == = ]]; then
        word=
    elif [[ $option == = ]]; then
        option=${COMP_WORDS[COMP_CWORD - 2]}
    fi
    local words=
    case $option in
    --access) words="all owner group=" ;;
    --bind) words="local 127.0.0.1" ;;
    --when-full) words="wait newest oldest disconnect" ;;
    *) [[ $word != -* ]] || words="
        -v --version -h --help -l --log= -L --file-log= -f --log-file= --json-log= --json-file=
        --log-size= --log-keep= -p --port= -c --direct -i --ignore= -I --ignore-file= -s --silent
        -u --no-console --prompt -r --resend --expected-modules= --bind= --access=
        --hosts-allow= --hosts-deny= --pid-file= --port-file= --metrics= --when-full=
        --limit-message-bytes= --limit-name-bytes= --limit-queue-bytes=
        --limit-queue-messages= --limit-unsent-bytes= --limit-progress-seconds=
        --limit-stuck-seconds= --limit-introduction-seconds= --limit-look-up-seconds=
        --limit-strangers=" ;;
    esac
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
    [[ ${COMPREPLY[*]} != *= ]] || compopt -o nospace 2>/dev/null
}
complete -o default -F _central central
