#!/bin/sh
# Fits of batten-mpi beside those of the program. Usage: surface.sh equal|solvers|resume|bad BATTEN BATTEN_MPI MPIRUN
set -u
what=$1
batten=$2
mpi=$3
mpirun=$4
here=$(cd "$(dirname "$0")" && pwd)
# Open MPI refuses to run for root, as in containers, unless both are set. Ranks beyond the processors give way to others.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_btl_vader_single_copy_mechanism=none
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0

check()
{
    name=$1
    shift
    "$@" || { echo "FAILED: $name"; sed 's/^/    /' stderr; failures=$((failures + 1)); }
}

# ranks N CODE ARGUMENTS…: N ranks must end with CODE. What they print is in stdout and stderr.
ranks()
{
    count=$1
    code=$2
    shift 2
    "$mpirun" -n "$count" "$mpi" surface "$@" > stdout 2> stderr < /dev/null
    got=$?
    check "exit code $got instead of $code: $count ranks, $*" test $got -eq "$code"
}

python3 "$here/points.py" 6000 in.xyz in.uv in.ply || exit 1
given="in.xyz --parameterization in.uv"

# near A B: whether two surfaces in XML agree to 1e-9.
near()
{
    python3 - "$1" "$2" << 'END'
import re, sys
one, other = ([float(word) for word in re.search("<coefs[^>]*>(.*?)</coefs>", open(path).read(), re.S)[1].split()]
              for path in sys.argv[1:])
sys.exit(len(one) != len(other) or max(abs(a - b) for a, b in zip(one, other)) > 1e-9)
END
}

case $what in
equal)
    # The same bytes for any number of ranks, from text and PLY; without parameters of the boundary too.
    "$batten" surface $given -o one.xml --quiet 2> stderr
    for n in 1 2 4; do
        ranks $n 0 $given -o $n.xml
        check "$n ranks give the surface of one machine" cmp one.xml $n.xml
        check "no checkpoint stays" test ! -e $n.xml.checkpoint
    done
    check "what was sent is told" grep -q "^4 ranks: [1-9][0-9]* bytes sent in [1-9][0-9]* messages" stdout
    ranks 3 0 in.ply --boundary 80 -o ply.xml --json
    check "PLY gives the same" cmp one.xml ply.xml
    check "JSON tells what was sent" grep -q '"largest_memory"' stdout
    check "a repeated point is left out" grep -q '"duplicates": 1' stdout
    "$batten" surface $given --robust --tolerance 1e-3 --degree 3,2 --final-corrections 1 -o one.step --quiet 2> stderr
    ranks 2 0 $given --robust --tolerance 1e-3 --degree 3,2 --final-corrections 1 -o two.step
    check "other options too" cmp one.step two.step
    ;;
solvers)
    "$batten" surface $given --functions 150 -o one.xml --quiet 2> stderr
    for solver in direct iterative; do
        ranks 2 0 $given --functions 150 --solver $solver -o two.xml
        check "$solver agrees to 1e-9" near one.xml two.xml
    done
    ;;
resume)
    # Killed after some round, and taken up by another number of ranks.
    "$batten" surface $given --functions 500 -o one.xml --quiet 2> stderr
    for n in 2 4; do
        killed=no
        for attempt in 1 2 3 4 5; do
            "$mpirun" -n $n "$mpi" surface $given --functions 500 --checkpoint state -o two.xml > stdout 2> stderr < /dev/null &
            running=$!
            while kill -0 $running 2> /dev/null && [ ! -e state ]; do sleep 0.01; done
            rank=$(pgrep -P $running | sed -n "${attempt}p")
            [ -n "$rank" ] && kill -9 "$rank" 2> /dev/null
            wait $running 2> /dev/null
            [ -e two.xml ] || killed=yes
            [ -e state ] && break
        done
        check "a run was killed" test $killed = yes
        check "a state is there" test -e state
        ranks 3 0 $given --functions 500 --checkpoint state -o two.xml
        check "the run went on" grep -q "went on after [1-9]" stdout
        check "killed and resumed gives the same bytes" cmp one.xml two.xml
        check "the state is gone" test ! -e state
        rm -f two.xml
    done
    ;;
bad)
    bad()
    {
        text=$1
        code=$2
        shift 2
        ranks 2 "$code" "$@" -o out.xml
        check "the message has '$text'" grep -q "$text" stderr
        check "one message" test "$(grep -c '^batten: ' stderr)" -eq 1
        check "nothing is written" test ! -e out.xml
    }
    bad "cannot read" 1 missing.xyz
    bad "in.xyz:2: is not x y z u v" 1 in.xyz
    (sed 4000q in.xyz; echo "1 2 x"; sed 1,4000d in.xyz) > word.xyz
    bad "word.xyz:4001: is not x y z" 1 word.xyz --parameterization in.uv
    sed '$d' in.uv > short.uv
    bad "has not as many lines" 1 in.xyz --parameterization short.uv
    sed '3000s/.*/2 0/' in.uv > outside.uv
    bad "outside the unit square" 1 in.xyz --parameterization outside.uv
    sed '3000s/.*/0 nan 0/' in.xyz > nan.xyz
    bad "not finite" 1 nan.xyz --parameterization in.uv
    bad "repeats another" 1 $given --strict
    head -c 100000 in.ply > short.ply
    bad "ends before the last vertex" 1 short.ply
    bad "the surface is wrong" 1 $given --smoothing 1e6
    bad "tolerance takes a number above 0" 2 $given --tolerance 0
    ranks 2 2 $given -o out.what
    check "no ending" grep -q "names no format" stderr
    : > state
    bad "checkpoint is that of another input" 1 $given --checkpoint state
    ;;
esac
[ $failures -eq 0 ]
