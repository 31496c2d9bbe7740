#ifndef CLI_VERB_H
#define CLI_VERB_H

#include "outputs.h"

#include "batten/distributed.h"

/// @file
/// Verbs: what each tells of itself, and how all of them run.

/// The begin of the job of every verb: what was given, and the files.
typedef struct verb_call
{
    const arguments *given;
    const char *input;            ///< the first argument that is no option; null for none
    const char *output, *picture; ///< null where not given
    outputs files;
    bool json;
    bool silent; ///< --quiet
    bool quiet;  ///< no report: --quiet, or standard output has the result
    int threads; ///< --threads; 0 for the default
} verb_call;

/// A verb. Its functions take its job, which begins with a verb_call; those that return an int return the program's exit
/// code. All but `make` may be null.
typedef struct verb
{
    const char *program;   ///< null for "batten"
    const char *name;      ///< "curve", "train mesh"
    const char *arguments; ///< what follows the name: "IN... [-o OUT] [options]"
    const char *summary;   ///< one line
    const char *about;     ///< a paragraph
    const char *example;   ///< a command, or several lines
    const option_table *options;
    size_t min_positional, max_positional;
    bool reads_files;          ///< the positional arguments are files that are read
    bool prints_result;        ///< without any output and --json, the result goes to standard output
    const char *words;         ///< what the first positional argument may be, separated by blanks; null for other things
    const char *list;          ///< of what `batten list` prints it may be; null for none
    const bat_family *formats; ///< the formats of OUT of a verb that takes several inputs; else null
    size_t job_size;
    void (*begin)(void *job); ///< sets defaults
    bool (*check)(void *job); ///< reads what no row of the options reads, and checks all. False after a message
    int (*make)(void *job);   ///< everything that can fail, the files but OUT included
    int (*write)(void *job, const char *path); ///< writes OUT
    int (*report)(void *job);                  ///< once all files are in their places
    void (*end)(void *job);                    ///< releases what the job holds
} verb;

/// Read a command line and run a verb. Returns the program's exit code.
int verb_run(const verb *what, int argc, char **argv);

/// The verb `train`, with its command line, divided among the processes of a group. Rank 0 prints failures.
/// @param processes null for a process alone
/// @param threads   of each process where --threads is not given; 0: all processors
/// @return the program's exit code
int train_in_group(int argc, char **argv, const bat_group *processes, int threads);

// Options that verbs share. Their fields are in verb_call.
extern const option_spec OUTPUT_OPTION[], JSON_OPTION[], REPORT_OPTIONS[], THREADS_OPTION[], MANY_OPTIONS[];

/// All verbs, null at the end.
extern const verb *const VERBS[];

extern const verb VERB_ANALYZE, VERB_COMPLETION, VERB_CURVE, VERB_DECIMATE, VERB_LIST, VERB_MANUAL, VERB_MEASURE, VERB_MESH,
    VERB_MOTION, VERB_REPRODUCE, VERB_SHAPE, VERB_SURFACE, VERB_TRAIN_CURVE, VERB_TRAIN_MESH, VERB_TRAIN_SURFACE;

#endif
