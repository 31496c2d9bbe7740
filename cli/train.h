#ifndef CLI_TRAIN_H
#define CLI_TRAIN_H

#include "batten/base.h"
#include "batten/distributed.h"

/// The verb `train`, with its command line, divided among the processes of a group. Rank 0 prints failures.
/// @param processes null for a process alone
/// @param threads   of each process where --threads is not given; 0: all processors
/// @return the program's exit code
int train_in_group(int argc, char **argv, const bat_group *processes, int threads);

#endif
