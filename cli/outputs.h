#ifndef CLI_OUTPUTS_H
#define CLI_OUTPUTS_H

#include "arguments.h"

#include "batten/base.h"

/// @file
/// The files that a call writes. They appear together, or none does.

enum
{
    MAX_OUTPUTS = 4
};

/// The files of the options that write or draw.
typedef struct outputs
{
    bat_outputs *files; ///< null once they are closed
    struct
    {
        const char *option, *path, *write_to;
    } each[MAX_OUTPUTS];
    size_t count;
    const char *folder; ///< of further files, which the verb adds; null for none
    bool piped;         ///< -o is standard output, which is written after the files
} outputs;

/// Whether a path, which may be null, is standard output.
bool is_standard_output(const char *path);

/// Open the files. Two outputs to one file, and an output to a file that is read (but for -o to IN), are a bad command line;
/// pictures need an ending that tells their format. Returns the program's exit code; after a failure nothing is open.
int outputs_open(const arguments *given, outputs *out);

/// Where to write what belongs to an option; null where it was not given. For standard output beside other files this is
/// /dev/null, to find what cannot be written before those appear; alone it is null.
const char *output_path(const outputs *out, const char *option);

/// Put the files in their places when `code` is EXIT_DONE, else remove them. Returns the program's exit code.
int outputs_close(outputs *out, int code);

#endif
