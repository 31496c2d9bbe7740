#!/bin/sh
# Fits of batten-mpi beside those of the program. Usage: surface.sh equal|cloud|solvers|resume|bad BATTEN BATTEN_MPI MPIRUN
#
# The words of $given are a file and an option.
# shellcheck disable=SC2086
set -u
what=$1
batten=$2
mpi=$3
mpirun=$4
verb=surface
. "$(dirname "$0")/ranks.sh"

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

# same_report A B: whether two reports in JSON agree in all but times and what was sent.
same_report()
{
    python3 - "$1" "$2" 2> stderr << 'END'
import json, sys

def compare(one, other, path):
    if isinstance(one, dict):
        for key in one:
            if "seconds" not in key and key not in ("exchange", "resumed"):
                compare(one[key], other[key], path + "/" + key)
    elif isinstance(one, list) and one:
        assert len(one) == len(other), path
        for k, item in enumerate(one):
            compare(item, other[k], path + "/" + str(k))
    else:
        assert one == other, (path, one, other)

compare(*(json.load(open(path)) for path in sys.argv[1:]), "")
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
    "$batten" surface $given --robust --tolerance 1e-3 --degree 3,2 --final-corrections 1 -o one.step --force --quiet 2> stderr
    ranks 2 0 $given --robust --tolerance 1e-3 --degree 3,2 --final-corrections 1 -o two.step --force
    check "other options too" cmp one.step two.step
    ;;
cloud)
    # Points without parameters: the same bytes as by one machine, for any number of ranks; a few points too.
    python3 "$here/points.py" 23000 cloud.xyz cloud.uv cloud.ply || exit 1
    grep -v '^#' cloud.xyz > raw.xyz
    "$batten" surface raw.xyz -o one.xml --json > one.json 2> stderr
    for n in 1 2 4; do
        ranks $n 0 raw.xyz -o $n.xml --json
        check "$n ranks give the surface of one machine" cmp one.xml $n.xml
        check "and its report" same_report one.json stdout
        check "no checkpoint stays" test -z "$(ls | grep checkpoint)"
    done
    "$batten" surface cloud.xyz --robust --tolerance 2e-3 --share 0.9 -o one.step --quiet 2> stderr
    ranks 3 0 cloud.ply --parameterization auto --boundary 80 --robust --tolerance 2e-3 --share 0.9 -o three.step --quiet
    check "a boundary that is known, and other options" cmp one.step three.step
    sed 3000q raw.xyz > few.xyz
    "$batten" surface few.xyz -o one.xml --quiet 2> stderr
    ranks 2 0 few.xyz -o two.xml
    check "few points" cmp one.xml two.xml
    # By a sample: the same bytes for any number of ranks, near the surface by all points.
    for n in 1 3; do
        ranks $n 0 raw.xyz --sample 22000 -o sample$n.xml --json
    done
    check "a sample gives the same for any number of ranks" cmp sample1.xml sample3.xml
    check "it is not all points" test "$(cmp -s one.xml sample1.xml; echo $?)" -ne 0
    python3 - one.json stdout << 'END' 2> stderr
import json, sys
one, other = (json.load(open(path)) for path in sys.argv[1:])
assert one["verdict"]["fault"] == other["verdict"]["fault"], (one["verdict"], other["verdict"])
one, other = one["rounds"][-1], other["rounds"][-1]
assert other["rms"] < 1.05 * one["rms"] and other["largest"] < 1.6 * one["largest"], (one, other)
END
    check "a sample gives a surface as good" test $? -eq 0
    # Killed and taken up.
    for attempt in 1 2 3 4 5; do
        cut_short 2 2 state raw.xyz --checkpoint state -o killed.xml
        [ -e state ] && break
    done
    check "a state is there" test -e state
    "$batten" surface raw.xyz -o one.xml --quiet 2> stderr
    ranks 3 0 raw.xyz --checkpoint state -o killed.xml
    check "the run went on" grep -q "went on after [1-9]" stdout
    check "killed and resumed gives the same bytes" cmp one.xml killed.xml
    # Clouds without a surface of their own: the message of one machine.
    python3 - << 'END'
import math, random
draw = random.Random(3)
with open("ring.xyz", "w") as ring, open("ball.xyz", "w") as ball:
    for _ in range(22000):
        t, r = 2 * math.pi * draw.random(), math.sqrt(0.1 + 0.9 * draw.random())
        print(r * math.cos(t), r * math.sin(t), 0.1 * r, file=ring)
        z = 2 * draw.random() - 1
        print(math.sqrt(1 - z * z) * math.cos(t), math.sqrt(1 - z * z) * math.sin(t), z, file=ball)
END
    for shape in ring ball; do
        # With a number of functions one machine keeps to a patch, too.
        "$batten" surface $shape.xyz --functions 150 -o out.xml > stdout 2> one.text
        ranks 2 1 $shape.xyz --functions 150 -o out.xml
        check "the message of one machine for a $shape" test "$(grep '^batten:' stderr)" = "$(sed 's/; --.*//' one.text)"
        check "nothing is written" test ! -e out.xml
    done
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
            cut_short $n $attempt state $given --functions 500 --checkpoint state -o two.xml
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
    (grep -v '^#' in.xyz | paste -d' ' - in.uv; echo "1 2 3 4") > five.xyz
    bad "five.xyz:6002: is not x y z u v" 1 five.xyz
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
    bad "tolerance is 0, but must be finite and above 0" 2 $given --tolerance 0
    ranks 2 2 $given -o out.what
    check "no ending" grep -q "names no format" stderr
    : > state
    bad "checkpoint is that of another input" 1 $given --checkpoint state
    ;;
esac
[ $failures -eq 0 ]
