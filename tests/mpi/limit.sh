#!/bin/sh
# A cloud that one process cannot fit under a limit of its memory, fitted by many ranks under the same limit.
# Usage: limit.sh BATTEN_MPI MPIRUN POINTS RANKS MIB [OPTIONS OF THE FIT...]
# MIB is the limit of each process (ulimit -d), in MiB; OpenBLAS alone maps 128 of them on rank 0.
set -u
mpi=$1
mpirun=$2
points=$3
count=$4
limit=$5
shift 5
export OPENBLAS_NUM_THREADS=1
. "$(dirname "$0")/ranks.sh"
# Rows of 5 doubles, in blocks of a lattice that is moved by less than its step.
python3 - "$points" << 'END' || exit 1
import math, struct, sys
from array import array

count, side = int(sys.argv[1]), 500
block = side * side
blocks = -(-count // block)
with open("cloud.ply", "wb") as ply:
    names = "".join(f"property double {name}\n" for name in "xyzuv")
    ply.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {blocks * block}\n{names}end_header\n".encode())
    wave = [0.1 * math.sin(5 * k / side) for k in range(side)]
    for b in range(blocks):
        du, dv = (b * 0.754877666 % 1) / side, (b * 0.569840291 % 1) / side
        rows = array("d")
        for i in range(side):
            u = i / side + du
            for j in range(side):
                v = j / side + dv
                rows.extend((u, v, wave[i] + wave[j], u, v))
        ply.write(rows.tobytes())
END
bytes=$(wc -c < cloud.ply)
echo "the file has $((bytes / 1048576)) MiB, $((bytes * 10 / 1048576 / limit)) tenths of the limit"

fit()
{
    ranks=$1
    shift
    "$mpirun" -n "$ranks" sh -c 'ulimit -d '$((limit * 1024))'; exec "$@"' sh "$mpi" surface cloud.ply -o out.xml "$@" > stdout 2> stderr < /dev/null
}

fit 1 "$@"
code=$?
[ $code -eq 1 ] && grep -q "^batten: .*out of memory" stderr && [ ! -e out.xml ] ||
    { echo "FAILED: one process ends with code $code"; cat stderr; exit 1; }
grep "^batten: " stderr
fit "$count" "$@"
code=$?
[ $code -eq 0 ] && [ -s out.xml ] || { echo "FAILED: $count ranks end with code $code"; cat stderr; exit 1; }
tail -n 2 stdout
