#ifndef CLI_REPRODUCE_H
#define CLI_REPRODUCE_H

#include "batten/tension_data.h"

#include <stdbool.h>
#include <stddef.h>

/// The published results that can be reproduced; `index` from 0 on. False past the last.
bool reproduce_row(size_t index, const char **name, const char **summary);

/// What the command line of `batten reproduce` asks for beside the result's name.
typedef struct reproduce_job
{
    const char *folder;          ///< for pictures; null for none
    const char *model;           ///< the file of a learned tension, for a row more; null for none
    bat_tension_set_kind curves; ///< which curves a table is taken on
    bool json;                   ///< print one JSON object
} reproduce_job;

/// One result each: print it, write its pictures to the folder where it has any, and return the program's exit code.
int reproduce_curve_figures(const reproduce_job *job);
int reproduce_tension_table1(const reproduce_job *job);
int reproduce_tension_iss(const reproduce_job *job);

#endif
