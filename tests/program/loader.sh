#!/bin/sh
# The program starts by its path, by links, and through the dynamic loader, as the portable tarball starts it. It begins anew
# where /proc/self/exe is the program, and only there. Usage: loader.sh BATTEN READELF PORTABLE
set -u
batten=$1 readelf=$2 portable=$3
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0
unset OMP_WAIT_POLICY GOMP_SPINCOUNT KMP_BLOCKTIME

fail()
{
    echo "FAILED: $1"
    cat stderr
    failures=$((failures + 1))
}

# lists NAME COMMAND…: the command, with two words, prints what the program does.
lists()
{
    name=$1
    shift
    "$@" list schemes > stdout 2> stderr < /dev/null || fail "$name: exit code $?"
    cmp -s expected stdout || fail "$name: another list of schemes"
}

# waits NAME SPINS COMMAND…: whether the environment that the program was last started with says how threads wait.
waits()
{
    name=$1 spins=$2
    shift 2
    rm -f input
    mkfifo input
    "$@" curve - --to csv > stdout 2> stderr < input &
    exec 3> input
    for _ in 1 2 3 4 5 6 7 8 9 10; do
        sleep 0.3
        tr '\0' '\n' < "/proc/$!/environ" > environment
        [ "$(sed -n 's/^GOMP_SPINCOUNT=//p' environment)" != "$spins" ] || break
    done
    printf '0,0\n1,0\n1,1\n' >&3
    exec 3>&-
    wait $! || fail "$name: exit code $?"
    [ "$(sed -n 's/^GOMP_SPINCOUNT=//p' environment)" = "$spins" ] || fail "$name: GOMP_SPINCOUNT is not '$spins'"
}

OMP_WAIT_POLICY=passive "$batten" list schemes > expected
loader=$("$readelf" -l "$batten" | sed -n 's/.*program interpreter: \(.*\)\]$/\1/p')
ln -s "$batten" linked
# The tree of the portable tarball, with the libraries of this machine.
mkdir -p tree/bin tree/lib tree/libexec tree/share/fonts
cp "$portable" tree/bin/batten
ln -s "$batten" tree/libexec/batten
ln -s "$loader" tree/lib/loader

lists path "$batten"
lists link ./linked
lists loader "$loader" "$batten"
lists portable tree/bin/batten
lists 'loader, quiet' env GOMP_SPINCOUNT=5 "$loader" "$batten"
if [ -e /proc/self/environ ] && ldd "$batten" | grep -q libgomp; then
    waits path 1000 "$batten"
    waits link 1000 ./linked
    waits loader '' "$loader" "$batten"
    waits portable 1000 tree/bin/batten
    waits 'portable, told' 7 env GOMP_SPINCOUNT=7 tree/bin/batten
fi
# Emulated, where QEMU is there.
emulator=$(command -v "qemu-$(uname -m)-static" || command -v "qemu-$(uname -m)") && lists emulator "$emulator" "$batten"
exit $((failures > 0))
