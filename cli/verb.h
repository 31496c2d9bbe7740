#pragma once

#include "report.h"

#include "batten/mesh_file.h"
#include "batten/research/distributed.h"
#include "batten/surface.h"

/// @file
/// Verbs: what each tells of itself, and how all of them run.

// The files that a call writes. They appear together, or none does.

enum
{
    MAX_OUTPUTS = 4,
    MAX_TABLES = 8 ///< of options of a verb, with an empty one at the end
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

/// Where to write what belongs to an option; null where it was not given. For standard output beside other files this is
/// /dev/null, to find what cannot be written before those appear; alone it is null.
const char *output_path(const outputs *out, const char *option);

// Verbs

/// The begin of the job of every verb: what was given, and the files.
typedef struct verb_call
{
    const arguments *given;
    const char *input;            ///< the first argument that is no option; null for none
    const char *output, *picture; ///< null where not given
    outputs files;
    bool json;
    bool silent;                    ///< --quiet
    bool quiet;                     ///< no report: --quiet, or standard output has the result
    int threads;                    ///< --threads; 0 for the default
    double max_seconds, max_memory; ///< of --max-memory in megabytes; 0 for no limit
} verb_call;

/// Print the notes of files, as far as the call wants them.
void print_file_notes(const verb_call *call, const bat_mesh_notes *notes);
json_t *file_notes_json(const bat_mesh_notes *notes);
/// Append a note. False when out of memory.
bool add_file_note(bat_mesh_notes *notes, const char *text);

enum
{
    FOLDER_PATH_SIZE = 4096
};

/// "folder/name" in a buffer. Returns the program's exit code.
int folder_path(const char *folder, const char *name, char path[FOLDER_PATH_SIZE]);

/// A further file: where it goes, and where it is written first.
typedef struct output_file
{
    char path[FOLDER_PATH_SIZE];
    const char *write_to;
} output_file;

/// Add a file of that name in a folder. Returns the program's exit code.
int output_add(const verb_call *call, const char *folder, const char *name, output_file *file);

/// The functions of a verb. They take its job, which begins with a verb_call; those that return an int return the program's
/// exit code. All but `make` may be null.
typedef struct verb_calls
{
    void (*begin)(void *job); ///< sets defaults
    bool (*check)(void *job); ///< reads what no row of the options reads, and checks all. False after a message
    int (*make)(void *job);   ///< everything that can fail, the files but OUT included
    int (*write)(void *job, const char *path); ///< writes OUT
    int (*report)(void *job);                  ///< once all files are in their places
    void (*end)(void *job);                    ///< releases what the job holds
} verb_calls;

typedef struct verb
{
    const char *program;   ///< null for "batten"
    const char *name;      ///< "curve", "train mesh"
    const char *arguments; ///< what follows the name: "IN... [-o OUT] [options]"
    const char *summary;   ///< one line
    const char *about;     ///< a paragraph
    const char *example;   ///< a command, or several lines
    option_table options[MAX_TABLES];
    struct
    {
        size_t min, max;
    } positional;              ///< how many arguments are no options
    bool reads_files;          ///< the positional arguments are files that are read
    bool prints_result;        ///< without any output and --json, the result goes to standard output
    const char *words;         ///< what the first positional argument may be, separated by blanks; null for other things
    const char *list;          ///< of what `batten list` prints it may be; null for none
    const bat_family *formats; ///< of OUT, of a verb that takes any number of files and all options below; else null
    size_t job_size;           ///< 0: that of a verb_call
    verb_calls calls;
} verb;

/// Read a command line and run a verb. Returns the program's exit code.
int verb_run(const verb *what, int argc, char **argv);

// Several inputs in one call: each in a process of its own, several at a time, its output in a folder.

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

/// The verb `train`, with its command line, divided among the processes of a group. Rank 0 prints failures.
/// @param processes null for a process alone
/// @param threads   of each process where --threads is not given; 0: all processors
/// @return the program's exit code
int train_in_group(int argc, char **argv, const bat_group *processes, int threads);

// The help of a verb, made of its tables.

enum
{
    /// The maximum number of characters on a line.
    HELP_WIDTH = 100,
    /// Of a summary, with its final zero.
    HELP_TEXT_SIZE = 1024,
    HELP_GROUPS = CALL + 1
};

/// The headings of the groups of options.
extern const char *const HELP_HEADINGS[HELP_GROUPS];

/// The name of a verb's program.
const char *verb_program(const verb *what);

/// The summary of an option, with the names of its family in the place of "{}".
/// @param text [HELP_TEXT_SIZE], may receive it
const char *help_summary(const option_spec *option, char *text);
/// Print the help of a verb: its common options, or all of them.
void help_print(const verb *what, bool all);

// Options that verbs share. Their fields are in verb_call.
extern const option_spec OUTPUT_OPTION[], JSON_OPTION[], REPORT_OPTIONS[], THREADS_OPTION[], MANY_OPTIONS[];

// The options of a fit of a surface, and its report, which two programs have.

/// Options for a bat_surface_fit_options, and for a bat_surface_write_options.
extern const option_spec SURFACE_FIT_OPTIONS[], SURFACE_WRITE_OPTIONS[];

/// Read what no row reads, and check the options of the fit. False after a message.
bool surface_check_fit(const arguments *given, bat_surface_fit_options *fit);

/// What a file holds of a simple shape.
typedef struct surface_written
{
    size_t edges[3]; ///< splines, lines, circles
    double area;     ///< NaN for a spline
} surface_written;

/// What is reported on.
typedef struct surface_findings
{
    const char *input;
    const bat_cloud *cloud;
    const bat_surface_reconstruct_options *options;
    const bat_surface_result *result;
    const bat_mesh_notes *notes; ///< of reading
    const bat_surface_primitive *shape;
    const surface_written *written;
} surface_findings;

/// Characters of a verdict in words, its end included.
#define SURFACE_VERDICT_SIZE 120
/// The verdict in words, written into `text`: "right", "right, but ..." or "wrong: ...".
const char *surface_verdict(const bat_surface_verdict *verdict, char text[SURFACE_VERDICT_SIZE]);
/// Tell the simple shape that points lie on, and what was written of it, which may be null; the null of JSON without a
/// shape.
json_t *surface_shape(const bat_surface_primitive *found, const surface_written *written, bool as_json);
/// Print the report and return null, or return it as an object, which is null where memory ran out.
json_t *surface_report(const surface_findings *findings, bool as_json);

/// All verbs, null at the end.
extern const verb *const VERBS[];

extern const verb VERB_ANALYZE, VERB_COMPLETION, VERB_CURVE, VERB_DECIMATE, VERB_LIST, VERB_MANUAL, VERB_MEASURE, VERB_MESH,
    VERB_MOTION, VERB_REPRODUCE, VERB_SHAPE, VERB_SURFACE, VERB_TRAIN_CURVE, VERB_TRAIN_MESH, VERB_TRAIN_SURFACE;

/// The published results that can be reproduced; `index` from 0 on. False past the last.
bool reproduce_row(size_t index, const char **name, const char **summary);
