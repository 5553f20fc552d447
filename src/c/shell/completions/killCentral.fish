# Completion of killCentral's command line, for fish.
complete -c killCentral -f
complete -c killCentral -s h -l help -d 'Print how it is used'
complete -c killCentral -a '(__fish_print_hostnames)' -d 'Server'
