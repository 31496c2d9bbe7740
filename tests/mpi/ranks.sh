# What the tests of batten-mpi share; read by them with `.`. They set $verb, $mpi and $mpirun.
# It enters an empty folder, which is removed in the end.

here=$(cd "$(dirname "$0")" && pwd)
# Open MPI refuses to run for root, as in containers, unless both are set. Ranks beyond the processors give way to others.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_btl_vader_single_copy_mechanism=none
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0
# Seconds for one run, at most ten times what it takes: a run that waits forever is told by its own line.
seconds=120

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
    timeout -k 10 $seconds "$mpirun" -n "$count" "$mpi" "$verb" "$@" > stdout 2> stderr < /dev/null
    got=$?
    check "exit code $got instead of $code: $count ranks, $*" test $got -eq "$code"
}

# cut_short N WHICH FILE ARGUMENTS…: starts N ranks, and kills the one numbered WHICH once FILE is there.
cut_short()
{
    count=$1
    which=$2
    awaited=$3
    shift 3
    timeout -k 10 $seconds "$mpirun" -n "$count" "$mpi" "$verb" "$@" > stdout 2> stderr < /dev/null &
    started=$!
    while kill -0 $started 2> /dev/null && [ ! -e "$awaited" ]; do sleep 0.01; done
    launcher=$(pgrep -P $started)
    rank=
    [ -z "$launcher" ] || rank=$(pgrep -P "$launcher" | sed -n "${which}p")
    [ -z "$rank" ] || kill -KILL "$rank" 2> /dev/null
    wait $started 2> /dev/null
}
