#ifndef MPI_RANKS_H
#define MPI_RANKS_H

#include "arguments.h"

#include <mpi.h>

/// @file
/// The processes of a call. Rank 0 talks to the user; a failure of one rank ends all.

int ranks_rank(void);
int ranks_count(void);

/// arguments_read() on all ranks, with messages of rank 0 alone.
bool ranks_read_arguments(const verb_spec *spec, int argc, char **argv, arguments *given, int *exit_code);

/// End all ranks with exit code 1, after one line as that of report_failure(), unless `error` is fine. Any rank may fail
/// alone.
void ranks_need(const char *file, bat_status status, const bat_error *error);
/// The same for memory.
void ranks_need_memory(const void *pointer, size_t bytes);

#endif
