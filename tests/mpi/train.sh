#!/bin/sh
# Trainings of batten-mpi give the bytes of the program. Usage: train.sh mesh|surface|bad BATTEN BATTEN_MPI MPIRUN
set -u
what=$1
batten=$2
mpi=$3
mpirun=$4
verb=train
. "$(dirname "$0")/ranks.sh"

same()
{
    check "$1 gives the same weights" cmp -s one/model.safetensors "$1/model.safetensors"
    check "$1 gives the same checkpoint" cmp -s one/checkpoint.safetensors "$1/checkpoint.safetensors"
}

# all ARGUMENTS…: by one process, by ranks with threads, and after the death of a rank.
all()
{
    rm -rf one ranks* killed
    "$batten" train "$@" --threads 1 --output one > one.out 2> stderr || exit 1
    for count in 1 2 3 4; do
        threads=1
        [ $count -ne 2 ] || threads=2
        ranks "$count" 0 "$@" --threads "$threads" --output "ranks$count"
        check "$count ranks report the same" test "$(sed '$d' stdout)" = "$(sed '$d' one.out)"
        check "they count what they send" grep -q "^$count ranks: [0-9]* bytes sent in [0-9]* messages" stderr
    done
    cut_short 3 3 killed/checkpoint.safetensors "$@" --output killed
    ranks 2 0 "$@" --resume --output killed
    same killed
}

case $what in
mesh)
    "$batten" shape stone --vertices 300 -o stone.obj > stdout 2> stderr || exit 1
    all mesh stone.obj --pairs 6 --batch 3 --epochs 6 --resampled 2 --vertices 20-30
    ;;
surface)
    all surface --epochs 3 --steps 3 --batch 9 --points 20-60
    ;;
bad)
    ranks 2 1 mesh missing.obj
    check "one message names the file" test "$(grep -c '^batten: missing.obj: ' stderr)" -eq 1
    check "no other message of batten" test "$(grep -c '^batten: ' stderr)" -eq 1
    ranks 2 2 mesh --batch none missing.obj
    check "one message names the option" test "$(grep -c '^batten: .*batch' stderr)" -eq 1
    ranks 2 1 surface --steps 50 --points 20-30 --epochs 1 --batch 2 --rate 1e300 --output bad
    check "one message says what is not finite" test "$(grep -c '^batten: .*not finite at step' stderr)" -eq 1
    ;;
esac
[ $failures -eq 0 ]
