#!/bin/sh
# Only verbs that compute products load OpenBLAS. Where a broken library stands in front of it they refuse, with one line, and the
# others work. The library is not looked for in the current folder. Usage: loading.sh BATTEN EXAMPLES LIBRARY
set -u
batten=$1 examples=$2 library=$3
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0

# check CODE ARGUMENTS…: the program must end with CODE.
check()
{
    code=$1
    shift
    "$batten" "$@" > stdout 2> stderr < /dev/null
    got=$?
    [ $got -eq "$code" ] || { echo "FAILED: exit code $got instead of $code: batten $*"; cat stderr; failures=$((failures + 1)); }
}

# refused ARGUMENTS…: the program must end with 1, say one line that names the library, and write nothing.
refused()
{
    check 1 "$@"
    [ "$(wc -l < stderr)" -eq 1 ] && grep -q "^batten: .*needs OpenBLAS, which cannot be loaded: .*$library" stderr &&
        [ ! -s stdout ] && [ -z "$(ls out.* 2> /dev/null)" ] || { echo "FAILED: batten $*"; cat stderr; failures=$((failures + 1)); }
    rm -f out.*
}

check 0 shape scan -o scan.xyz --vertices 200
mkdir broken
: > "broken/$library"
: > "$library"
check 0 surface scan.xyz -o fit.xml --force
[ -s fit.xml ] || { echo "FAILED: no surface"; failures=$((failures + 1)); }

export LD_LIBRARY_PATH="$folder/broken"
check 0 --version
check 0 list schemes
check 0 curve "$examples/coast.geojson" -o fine.geojson --picture fine.svg
check 0 motion "$examples/camera-keyframes.csv" -o fine.tum --rate 10
check 0 shape cage -o cage.obj
check 0 mesh cage.obj -o fine.obj --levels 2
check 0 decimate fine.obj -o coarse.obj --vertices 100
check 0 measure coarse.obj fine.obj
check 0 surface fit.xml -o out.step
rm -f out.*
refused surface scan.xyz -o out.xml --force
refused analyze four-point
refused train surface --epochs 1 -o run
exit $((failures > 0))
