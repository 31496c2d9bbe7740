#ifndef CLI_MANY_H
#define CLI_MANY_H

#include "arguments.h"

/// @file
/// Several inputs in one call: each in a process of its own, several at a time, its output in a folder.

/// What a verb makes of one input. Returns the program's exit code.
typedef int (*many_verb)(const arguments *given);

/// Whether a command line asks for several inputs, or for one whose output goes to a folder.
bool many_wanted(const arguments *given);

/// Run a verb for each input; -o names a folder. An output has the name of its input, with the ending of --to where it is
/// given; one that is an input is refused without --in-place. Each appears as a whole when it is done. A failed input does
/// not stop the others. A signal stops those that are under way and keeps those that are done.
///
/// @return the program's exit code: EXIT_BAD_INPUT when an input failed
int many_run(const arguments *given, many_verb run);

#endif
