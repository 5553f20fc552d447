# What the tests share, to be read in by them: a folder to work in, where the installed server runs
# on a free port that CENTRALHOST names, and functions.
set -eu
source=$PWD
cd "${AUTOPKGTEST_TMP:-$(mktemp -d)}"

# await PATTERN FILE: waits until a line of the file matches.
await() {
    tries=200
    until grep -qs -- "$1" "$2"; do
        tries=$((tries - 1))
        [ $tries -gt 0 ] || { echo "$2 lacks: $1"; cat "$2"; exit 1; }
        sleep 0.1
    done
}

# converse MODULE2 MODULE1: starts both, commands of one or more words, and lets the first one of
# the manual send a message and a query.
converse() {
    mkfifo keys1 keys2
    $1 <keys2 >module2.log 2>&1 &
    module2=$!
    exec 4>keys2
    await "Type 'q' to quit" module2.log
    $2 <keys1 >module1.log 2>&1 &
    module1=$!
    exec 3>keys1
    await "Type 'm' to send" module1.log
    printf 'm\n' >&3
    await 'Receiving message1 (42)' module2.log
    printf 'r\n' >&3
    await 'Receiving message2 (Hello, world)' module1.log
    await 'Received response' module1.log
    printf 'q\n' >&3
    wait $module1
    printf 'q\n' >&4
    wait $module2
    echo "The conversation is complete."
}

central -p0 -u >central.log 2>&1 &
server=$!
trap 'kill $server' EXIT
await 'Expecting 1 on port' central.log
CENTRALHOST=localhost:$(sed -n 's/.*Expecting 1 on port \([0-9]*\).*/\1/p' central.log)
export CENTRALHOST
