#ifndef BATTEN_BASE_H
#define BATTEN_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define BAT_API
#else
#define BAT_API __attribute__((visibility("default")))
#endif
/// Stands behind a parameter that a function does not use.
#define BAT_UNUSED __attribute__((unused))
/// Stands before a name that goes; `message` says what to use instead.
#define BAT_DEPRECATED(message) __attribute__((deprecated(message)))

#if defined(__cplusplus)
#define BAT_C_BEGIN                                                                                                         \
    extern "C"                                                                                                              \
    {
#define BAT_C_END }
#else
#define BAT_C_BEGIN
#define BAT_C_END
#endif

BAT_C_BEGIN

/// @file
/// The base of all headers: status codes, error texts, tables of choices, progress, files that appear together, random
/// streams, the version.

#define BAT_VERSION_MAJOR 1
#define BAT_VERSION_MINOR 0
#define BAT_VERSION_PATCH 0

/// The version of the library that is linked, as "major.minor.patch".
BAT_API const char *bat_version(void);

/// The result of a call. Every call that can fail returns one.
typedef enum bat_status
{
    BAT_OK = 0,
    BAT_INVALID_ARGUMENT, ///< an option is out of its range, or two options contradict each other
    BAT_INVALID_POINT,    ///< a point is not in its space, is not finite, or repeats its neighbour
    BAT_CUT_LOCUS,        ///< two neighbours have no unique shortest geodesic (antipodal points of a sphere)
    BAT_UNSUPPORTED,      ///< a combination without a meaning, for example a plane scheme on the sphere
    BAT_NO_CONVERGENCE,   ///< an iteration did not converge, or a scheme has no limit
    BAT_TOO_LARGE,        ///< a count overflows size_t or the limit that the caller set
    BAT_NO_MEMORY,        ///< an allocation failed
    BAT_BAD_FILE,         ///< the content of a file is wrong; bat_error::line says where
    BAT_FILE_ACCESS,      ///< a file cannot be opened, read, written or renamed
    BAT_CANCELLED,        ///< the caller's progress function returned false
    BAT_NOT_MANIFOLD ///< a mesh has an edge of three faces, faces that run against each other, or a vertex of several fans
} bat_status;

/// A short name of a status, for example "invalid point". Never null.
BAT_API const char *bat_status_name(bat_status status);

/// The default of every `max_points`: 2^40 - 1, or 2^26 - 1 where size_t has 32 bits.
#define BAT_MAX_POINTS (SIZE_MAX / (sizeof(size_t) > 4 ? 1 << 24 : 1 << 6))

#define BAT_NO_INDEX ((size_t)-1)
#define BAT_ERROR_TEXT_SIZE 280

/// A failure as data: its cause, its place, and what leads out. Only failing calls fill it. Every call takes null instead.
/// A program decides by the fields; `text` is for people alone. A program with names of its own for options prints them
/// for `option` and `remedy`.
typedef struct bat_error
{
    bat_status status;      ///< the cause
    size_t operand;         ///< the input of the call at fault, counted from 0; or BAT_NO_INDEX
    size_t curve;           ///< of a call for several curves, the one at fault, counted from 0; or BAT_NO_INDEX
    size_t index;           ///< the point, curve or coefficient at fault, counted from 0; or BAT_NO_INDEX
    size_t index_at;        ///< where `text` names the index, for a caller that numbers otherwise; 0: nowhere, or unknown
    size_t line;            ///< the line of the file at fault, counted from 1; 0 when there is none
    char option[32];        ///< the field of an options struct at fault, with which `text` begins; "" for none
    char remedy[32];        ///< the field of an options struct that leads out, as in "repair"; "" for none
    char remedy_effect[96]; ///< what it does, to follow its name, as in "cuts the mesh there"
    char text[BAT_ERROR_TEXT_SIZE]; ///< one line without a full stop; it names the index itself where there is one
} bat_error;

/// How a long call reports its progress and is stopped. All zero: no reports.
typedef struct bat_progress
{
    /// Called from time to time by the calling thread with the share done, 0 to 1. False stops the call with BAT_CANCELLED.
    /// May be null.
    bool (*report)(void *context, double fraction);
    void *context; ///< handed to `report`
} bat_progress;

/// What a file of a stranger may ask for. All zero: the defaults. Readers need memory in proportion to the two.
typedef struct bat_limits
{
    size_t bytes;  ///< the longest input; 0: any file, and 2^32 of a stream
    size_t points; ///< the most points that compression and instances make of it; 0: 2^20, and one for each of its bytes
} bat_limits;

/// Who may use a choice.
typedef enum bat_choice_use
{
    BAT_CHOICE_USE_LISTED,   ///< everybody: bat_choices() lists it, bat_choice_find() finds it
    BAT_CHOICE_USE_UNLISTED, ///< bat_choice_find() finds it, but no list has it: "auto" of formats
    BAT_CHOICE_USE_UNNAMED,  ///< a value for options that no name gives
    BAT_CHOICE_USE_RESULT    ///< a value of results alone, which options refuse
} bat_choice_use;

/// A choice of a family: a scheme, a space, a format.
typedef struct bat_choice
{
    const char *name;     ///< as bat_choice_find() takes it
    const char *settings; ///< what may follow the name after a colon, with the default values; null for none
    const char *summary;  ///< one line
    const char *endings;  ///< formats: endings of file names, separated by blanks; null for none
    bool reads, writes;   ///< formats: what the library can do
    int value;            ///< the enumerator, where the family has an enumeration; else 0
    bat_choice_use use;
} bat_choice;

/// How a measure is stored, and printed.
typedef enum bat_measure_form
{
    BAT_MEASURE_FORM_NUMBER, ///< double; NaN: the thing measured has none
    BAT_MEASURE_FORM_LENGTH, ///< double, of interest as a share of the size of what is measured
    BAT_MEASURE_FORM_POINT,  ///< double[3]
    BAT_MEASURE_FORM_COUNT,  ///< size_t
    BAT_MEASURE_FORM_SIGNED, ///< int64_t
    BAT_MEASURE_FORM_GENUS,  ///< int64_t; negative: the thing measured has none
    BAT_MEASURE_FORM_FLAG    ///< bool
} bat_measure_form;

/// A measure: a field of the struct that a measuring function fills in. Each such struct has one table of them, which
/// bat_..._measures() walks; the program and the page print that table.
typedef struct bat_measure
{
    const char *name;  ///< the field's, which the struct's comment defines
    const char *title; ///< for people; two blanks first where it belongs to the measure before
    bat_measure_form form;
    size_t offset; ///< of the field in its struct
} bat_measure;

/// A struct of options with the ranges of its fields. The table of bat_x_options is bat_x_fields, in the header of the
/// struct.
typedef struct bat_options_table
{
    const char *name;   ///< of the struct
    const void *fields; ///< `count` rows of the library: the fields and their ranges
    size_t count;
    bat_status (*check)(const void *options, bat_error *error); ///< what no range of a field tells; null for nothing
} bat_options_table;

/// Check options. Every call that takes options does so first; a caller may do so before a long preparation.
///
/// @param options the struct of the table; null passes
/// @return BAT_OK, or BAT_INVALID_ARGUMENT for the first field out of its range, which the error names
BAT_API bat_status bat_options_check(const bat_options_table *table, const void *options, bat_error *error);

/// A family of choices: a table whose rows begin with a bat_choice. The family of an enumeration bat_x is bat_x_family, in
/// the header of the enumeration.
typedef struct bat_family
{
    const char *what;                               ///< what a row is, for messages: "mesh scheme"
    const void *rows;                               ///< `count` rows of `size` bytes
    size_t size, count;                             ///< bytes of a row; number of rows
    const bat_choice *(*of_path)(const char *path); ///< formats: the row of a path whose ending does not tell; may be null
} bat_family;

/// The choices of a family that users may name, one by one; `index` from 0 on.
/// @return null past the last
BAT_API const bat_choice *bat_choices(const bat_family *family, size_t index);
/// The choice of a name.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names them all
BAT_API bat_status bat_choice_find(const bat_family *family, const char *name, const bat_choice **choice, bat_error *error);
/// The name of an enumerator; "unknown" for none. Never null.
BAT_API const char *bat_choice_name(const bat_family *family, int value);
/// The format of a path by its ending, in either case: letters and digits, a letter among them, after the last dot of the
/// name.
///
/// @param writes whether the file is to be written, else read
/// @param choice receives null on failure and for a name without an ending
/// @return BAT_OK, or BAT_INVALID_ARGUMENT for an ending that no such format has, with a text that lists the known ones
BAT_API bat_status bat_choice_of_path(const bat_family *family, const char *path, bool writes, const bat_choice **choice,
                                      bat_error *error);

/// Several files that appear together or not at all. Each is written to a temporary file beside its target by any writer of
/// the library or of your own; then all are renamed at once. Until then nothing is changed.
///
///     bat_outputs *outputs;
///     const char *mesh_path, *picture_path;
///     bat_outputs_make(&outputs, &error);
///     bat_outputs_add(outputs, "fine.obj", &mesh_path, &error);
///     bat_outputs_add(outputs, "fine.png", &picture_path, &error);
///     bat_mesh_write(mesh_path, &mesh, NULL, &error);
///     bat_mesh_picture_write(picture_path, panels, 2, NULL, &error);
///     bat_outputs_commit(outputs, &error);
///     bat_outputs_free(outputs);
///
/// A single file needs none of this: every bat_..._write() replaces its file as a whole.
typedef struct bat_outputs bat_outputs;

/// An empty set of files. Release it with bat_outputs_free().
/// @return BAT_OK or BAT_NO_MEMORY; `outputs` is untouched on failure
BAT_API bat_status bat_outputs_make(bat_outputs **outputs, bat_error *error);
/// Add a file. Links are followed. A special file (a pipe, a device) is written directly.
///
/// @param path     not standard output, which is to be written after the commit
/// @param write_to receives the path to write to; it has the ending of `path` and is valid until bat_outputs_free()
/// @param error    `index` counts the files in the order in which they were added
/// @return BAT_OK, BAT_INVALID_ARGUMENT (another output goes to the same file), BAT_FILE_ACCESS (the file or a new file in
///         its folder cannot be written) or BAT_NO_MEMORY; on failure the file is not added
BAT_API bat_status bat_outputs_add(bat_outputs *outputs, const char *path, const char **write_to, bat_error *error);
/// Put all files in their places: their content is forced to the disk, then they are renamed. When one cannot be renamed,
/// the others are taken back.
///
/// @param error `index` as in bat_outputs_add()
/// @return BAT_OK or BAT_FILE_ACCESS (also when a file was added but not written)
BAT_API bat_status bat_outputs_commit(bat_outputs *outputs, bat_error *error);
/// Remove the temporary files. This may be called from a signal handler of the thread that adds and commits.
BAT_API void bat_outputs_remove(const bat_outputs *outputs);
/// Remove the temporary files that are left and release the set. Null is fine.
BAT_API void bat_outputs_free(bat_outputs *outputs);

/// Remove hidden files that killed programs left in the folder of `path`: of processes that are gone, and not written for an
/// hour. Only the moment in which a file is replaced, file systems without nameless files, and GDAL can leave one.
/// @return the number of removed files
BAT_API size_t bat_outputs_sweep(const char *path);

/// A stream of pseudo-random numbers (xoshiro256++ of Blackman and Vigna, seeded through splitmix64). The same seed gives
/// the same bits and uniform numbers on every machine; normal ones may differ in the last digit.
typedef struct bat_random
{
    uint64_t state[4];
} bat_random;

/// A stream for a seed. Different seeds give unrelated streams.
BAT_API bat_random bat_random_seed(uint64_t seed);
/// The next 64 random bits.
BAT_API uint64_t bat_random_bits(bat_random *random);
/// A number from the uniform distribution on [0, 1), a multiple of 2^-53.
BAT_API double bat_random_uniform(bat_random *random);
/// A number from the standard normal distribution.
BAT_API double bat_random_normal(bat_random *random);

BAT_C_END

#endif
