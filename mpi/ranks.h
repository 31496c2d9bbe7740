#ifndef MPI_RANKS_H
#define MPI_RANKS_H

#include "arguments.h"

#include <mpi.h>

/// @file
/// The processes of a call. Rank 0 talks to the user; a failure of one rank ends all.

int ranks_rank(void);
int ranks_count(void);

/// Between these calls only rank 0 prints messages, while all ranks read the command line.
int ranks_silence(void);
void ranks_speak(int silence);

/// arguments_read() on all ranks, with messages of rank 0 alone.
bool ranks_read_arguments(const struct verb *what, int argc, char **argv, arguments *given, int *exit_code);

/// The failure of the lowest rank that failed; every rank receives it.
bat_status ranks_agree_on(bat_status status, bat_error *error);
/// Whether all ranks are fine. Where some failed, rank 0 prints the failure of the lowest of them, as report_failure() does.
bool ranks_agree(const char *file, bat_status status, const bat_error *error);

/// Set an error that has no index, where `error` is not null.
/// @return `status`
bat_status ranks_fail(bat_error *error, bat_status status, const char *text);
/// End all ranks with exit code 1, after one line as that of report_failure(), unless `error` is fine. Any rank may fail
/// alone.
void ranks_need(const char *file, bat_status status, const bat_error *error);
/// An array of zeros; a failure ends all ranks.
void *ranks_allocate(size_t count, size_t size);
/// As realloc(); a failure ends all ranks.
void *ranks_grow(void *array, size_t count, size_t size);

#endif
