#ifndef CLI_MANY_H
#define CLI_MANY_H

#include "arguments.h"

/// @file
/// Several inputs in one call: each in a process of its own, several at a time, its output in a folder.

/// The rows of several inputs in a verb's table of options.
#define MANY_OPTIONS                                                                                                        \
    {"jobs", 0, "N", "of several IN: so many at a time, which share the threads; default 1"},                               \
    {                                                                                                                       \
        "in-place", 0, NULL, "of several IN: outputs may replace inputs"                                                    \
    }

/// What a verb makes of one input. Returns the program's exit code.
typedef int (*many_verb)(const arguments *given);

/// Read a command line and run a verb: once for a single input; else once for each, where -o names a folder. An output has
/// the name of its input, with the ending of --to where it is given; one that is an input is refused without --in-place.
/// Each appears as a whole when it is done. A failed input does not stop the others. A signal stops those that are under way
/// and keeps those that are done.
///
/// @param formats the table of formats of OUT
/// @return the program's exit code: EXIT_BAD_INPUT when an input failed
int many_run(const verb_spec *spec, const bat_family *formats, many_verb verb, int argc, char **argv);

#endif
