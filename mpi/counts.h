#ifndef MPI_COUNTS_H
#define MPI_COUNTS_H

#include <jansson.h>
#include <stdio.h>

/// @file
/// What the processes of a call exchange. Own versions of MPI's functions count each call, those of PETSc too, and call
/// MPI's profiling interface. What MUMPS sends goes through Fortran and is not counted.
///
/// A rank sends what it hands over: the bytes of a message; of a broadcast the root sends them to every other rank; of a
/// reduction to all, each sends 2 (P - 1) / P times the bytes of its numbers, as in a ring. How MPI forwards them is not
/// counted.

/// Counts of one rank.
typedef struct counts
{
    double bytes;    ///< sent to other ranks
    double messages; ///< sent to other ranks
    double waiting;  ///< seconds within calls that wait for others
    double memory;   ///< bytes: the largest resident set so far
} counts;

/// Add seconds that this rank waited for others outside the functions that wait by themselves.
void counts_wait(double seconds);

/// The counts of this rank since the start.
counts counts_now(void);

/// The counts of all ranks.
typedef struct counts_summary
{
    int ranks;
    counts sum, largest;
} counts_summary;

/// Collect the counts of all ranks; every rank receives the summary. Collective.
counts_summary counts_collect(void);

/// Print one line.
void counts_print(const counts_summary *summary, FILE *stream);
/// The same as a JSON object.
json_t *counts_json(const counts_summary *summary);

#endif
