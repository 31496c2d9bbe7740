"""Kill ranks of a training at random moments, resume it, and compare bytes.

    kills.py BATTEN BATTEN_MPI MPIRUN [--kills 20] [--ranks 3] [--seed 1] -- TRAINING...

TRAINING are the words after `batten train`, without --output. The training runs once in one process without a kill. Then one of
the ranks is killed with SIGKILL at a random moment of a run, and the next run resumes. Where a run is complete its weights and
its checkpoint are compared, and a new training begins. The last training is completed. Prints the kills and the result.
"""

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

FILES = ("model.safetensors", "checkpoint.safetensors")


def children(pid):
    """The processes that a process has started."""
    for name in os.listdir("/proc"):
        try:
            stat = Path("/proc", name, "stat").read_text() if name.isdigit() else ""
        except OSError:
            continue
        if stat and int(stat.rpartition(")")[2].split()[1]) == pid:
            yield int(name)


def main():
    words = sys.argv[1:]
    split = words.index("--")
    parser = argparse.ArgumentParser()
    parser.add_argument("batten")
    parser.add_argument("batten_mpi")
    parser.add_argument("mpirun")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--ranks", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    given, training = parser.parse_args(words[:split]), words[split + 1 :]
    draw = random.Random(given.seed)
    # Open MPI refuses to run for root, as in containers, unless both are set. Ranks beyond the processors give way to others.
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_rmaps_base_oversubscribe="1",
                      OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_btl_vader_single_copy_mechanism="none")  # fmt: skip
    with tempfile.TemporaryDirectory() as name:
        whole, parts = Path(name, "whole"), Path(name, "parts")
        quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        subprocess.run([given.batten, "train", *training, "--output", whole], check=True, **quiet)
        command = [given.mpirun, "-n", str(given.ranks), given.batten_mpi, "train", *training, "--output", parts, "--resume"]
        begin = time.monotonic()
        subprocess.run(command, check=True, **quiet)
        seconds = time.monotonic() - begin

        killed = completed = 0
        moments = []
        while True:
            if (parts / FILES[0]).exists():
                for file in FILES:
                    if (whole / file).read_bytes() != (parts / file).read_bytes():
                        sys.exit(f"{file} has other bytes after {killed} kills")
                completed += 1
                if killed >= given.kills:
                    break
                shutil.rmtree(parts)
            run = subprocess.Popen(command, **quiet)
            if killed < given.kills:
                wait = draw.uniform(0, 0.7 * seconds)
                try:
                    run.wait(timeout=wait)
                except subprocess.TimeoutExpired:
                    ranks = list(children(run.pid))
                    if ranks:
                        os.kill(draw.choice(ranks), signal.SIGKILL)
                        killed += 1
                        moments.append(wait)
            code = run.wait()
            if code == 0 and not (parts / FILES[0]).exists():
                sys.exit("a run ended without weights")
        print(f"{killed} kills of {given.ranks} ranks, {moments and min(moments):.2f} to {moments and max(moments):.2f} s after the start, "
              f"{completed} complete trainings, the same bytes: train {' '.join(training)}")  # fmt: skip


main()
