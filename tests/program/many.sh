#!/bin/sh
# Several inputs in one call: outputs, reports, failures, signals, and calls beside each other. Usage: many.sh BATTEN EXAMPLES
set -u
batten=$1
examples=$2
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0

check()
{
    what=$1
    shift
    "$@" || { echo "FAILED: $what"; sed 's/^/    /' stderr; failures=$((failures + 1)); }
}

# many CODE ARGUMENTS…: the program must end with CODE. What it prints is in stdout and stderr.
many()
{
    code=$1
    shift
    "$batten" "$@" > stdout 2> stderr < /dev/null
    got=$?
    check "exit code $got instead of $code: batten $*" test $got -eq "$code"
}


mkdir in
for i in 1 2 3 4 5 6; do
    printf '0,0\n1,0\n1,%d\n0,2\n' $i > in/$i.csv
    "$batten" curve in/$i.csv -o $i-alone.csv --quiet
done
printf '0,0\n1,nonsense\n' > in/bad.csv

# Each output is that of a call of its own, for any number of jobs.
many 0 curve in/[1-6].csv -o one
check "a report of one line each, in the order of the inputs" test "$(sed 's/:.*//' stdout)" = "$(for i in 1 2 3 4 5 6; do
    echo "in/$i.csv -> one/$i.csv"; done)"
check "nothing on standard error" test ! -s stderr
cp stdout stdout-one
many 0 curve in/[1-6].csv -o three/ --jobs 3
check "reports do not depend on --jobs" test "$(sed s/three/one/ stdout)" = "$(cat stdout-one)"
for i in 1 2 3 4 5 6; do
    check "output $i of one job" cmp $i-alone.csv one/$i.csv
    check "output $i of three jobs" cmp $i-alone.csv three/$i.csv
done
many 0 curve in/1.csv -o three/ --quiet
check "--quiet" test ! -s stdout
many 0 curve in/*1.csv -o single/
check "one input into a folder" cmp 1-alone.csv single/1.csv
cp -r in place
many 0 curve place/[1-6].csv -o place --jobs 2 --in-place
check "with --in-place results may replace their inputs" cmp 3-alone.csv place/3.csv

# Endings.
many 0 curve in/1.csv in/2.csv -o to --to obj
check "--to gives the ending" test -f to/1.obj -a -f to/2.obj
"$batten" shape cage -o cage.obj --quiet
cp cage.obj other.obj
many 0 mesh cage.obj other.obj -o meshes --to ply --jobs 2
check "meshes" cmp meshes/cage.ply meshes/other.ply
many 0 decimate cage.obj other.obj -o small --vertices 50 --jobs 2
check "coarse meshes" cmp small/cage.obj small/other.obj
awk 'BEGIN { srand(1); for (i = 0; i < 300; i++) { u = rand(); v = rand(); print u, v, 0.1 * u * v } }' > a.xyz
cp a.xyz b.xyz
many 2 surface a.xyz b.xyz -o surfaces
check "surfaces need --to" grep -q -- '--to does' stderr
many 0 surface a.xyz b.xyz -o surfaces --to xml --jobs 2
check "surfaces" cmp surfaces/a.xml surfaces/b.xml
many 0 motion "$examples/camera-keyframes.csv" "$examples/tensor-path.csv" -o motions --rate 10 --jobs 2
check "motions" test -s motions/camera-keyframes.csv -a -s motions/tensor-path.csv

# One that fails does not stop the others.
many 1 curve in/1.csv in/bad.csv none.csv in/2.csv -o some --jobs 2
check "the others are done" test "$(ls some | tr '\n' ' ')" = "1.csv 2.csv "
check "the failures are told, and how many" test "$(grep -c '^batten: \(in/bad.csv:2:\|none.csv:\|2 of 4 files are done\)' stderr)" -eq 3
check "reports of what is done" test "$(wc -l < stdout)" -eq 2
many 1 curve in/1.csv in/bad.csv -o some --json
check "one JSON object" grep -q '"failed": 1' stdout
check "a report in it" grep -q '"scheme": "learned"' stdout
check "an error in it" grep -q '"error": "batten: in/bad.csv:2:' stdout

# Command lines that are refused before anything is done.
refused()
{
    pattern=$1
    shift
    many 2 "$@"
    check "the message does not match '$pattern': batten $*" grep -q -e "$pattern" stderr
    check "two lines: batten $*" test "$(wc -l < stderr)" -eq 2
    check "no folder: batten $*" test ! -e new
}
refused 'need -o FOLDER' curve in/1.csv in/2.csv
refused 'need -o FOLDER' curve in/1.csv in/2.csv -o -
refused 'is a file' curve in/1.csv in/2.csv -o in/3.csv
refused 'would both be written' curve in/1.csv one/1.csv -o new
refused 'would both be written' curve in/1.csv in/1.csv -o new
refused 'standard input' curve in/1.csv - -o new
refused 'names one file' curve in/1.csv in/2.csv -o new --picture new.png
refused 'names no format' curve in/1.csv stdout-one -o new
refused 'nonsense., but must be a format' curve in/1.csv in/2.csv -o new --to nonsense
refused 'from 1 to' curve in/1.csv in/2.csv -o new --jobs 0
many 1 curve in/1.csv in/2.csv -o no/such
check "a folder that cannot be made" grep -q 'no/such: cannot make' stderr

# Outputs replace no input, by whatever path, unless that is asked for.
mkdir kept
cp in/1.csv in/2.csv kept
ln kept/2.csv kept/linked.csv
(cd kept && "$batten" curve 1.csv 2.csv -o . > ../stdout 2> ../stderr)
check "exit code $? of an output that is an input" test $? -eq 1
for path in kept kept/ kept/../kept; do
    many 1 curve kept/1.csv in/2.csv -o $path
    check "one line for $path" test "$(wc -l < stderr)" -eq 1
    check "the output is named" grep -q '^batten: kept.*/1.csv: the output would replace an input; --in-place' stderr
done
many 1 curve kept/1.csv -o kept/
many 1 curve in/1.csv kept/linked.csv -o kept
check "the inputs are as before" cmp in/1.csv kept/1.csv
check "the other input is as before" cmp in/2.csv kept/2.csv

# A signal keeps what is done, ends what is under way, and leaves no temporary file. The inputs that take long are last.
"$batten" mesh cage.obj -o fine.obj --levels 5 --scheme loop --quiet
mkdir long
cp cage.obj long/1.obj
for i in 2 3 4 5; do ln fine.obj long/$i.obj; done
for signal in INT TERM; do
    # A shell ignores SIGINT in what it puts in the background; env takes that back.
    env --default-signal=INT "$batten" mesh long/*.obj -o stopped-$signal --scheme loop --levels 4 --jobs 2 > stdout 2> stderr &
    process=$!
    while [ ! -e stopped-$signal/1.obj ] && kill -0 $process 2> /dev/null; do sleep 0.05; done
    kill -$signal $process
    wait $process
    got=$?
    check "exit code $got after SIG$signal" test $got -eq 1
    check "what was done is kept" test -s stopped-$signal/1.obj
    check "it is told that the call was stopped" grep -q '^batten: stopped$' stderr
    check "not all is done after SIG$signal" test ! -e stopped-$signal/5.obj
    check "no temporary file stays after SIG$signal" test -z "$(find . -name '.*' ! -name .)"
done

# Calls beside each other, in one folder: as those of make and of job arrays.
for part in 1 2 3; do
    "$batten" curve in/[1-6].csv -o shared --jobs 2 --quiet 2> stderr-$part &
done
wait
for i in 1 2 3 4 5 6; do
    check "output $i of three calls at once" cmp $i-alone.csv shared/$i.csv
done
check "no temporary file stays" test -z "$(find . -name '.*' ! -name .)"

[ $failures -eq 0 ] || { echo "$failures checks failed"; exit 1; }
