#ifndef CLI_REPRODUCE_H
#define CLI_REPRODUCE_H

#include <stdbool.h>
#include <stddef.h>

/// The published results that can be reproduced; `index` from 0 on. False past the last.
bool reproduce_row(size_t index, const char **name, const char **summary);

/// One result each: print it (as one JSON object if asked), write its pictures to `folder` where it has any, and return the
/// program's exit code.
int reproduce_curve_figures(const char *folder, bool as_json);
int reproduce_tension_table1(const char *folder, bool as_json);
int reproduce_tension_iss(const char *folder, bool as_json);

#endif
