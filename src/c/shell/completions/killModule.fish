# Completion of killModule's command line, for fish.
complete -c killModule -f
complete -c killModule -s h -l help -d 'Print how it is used'
complete -c killModule -n 'test (count (commandline -opc)) -eq 2' -a '(__fish_print_hostnames)' -d 'Server'
