#ifndef WEB_ENGINE_H
#define WEB_ENGINE_H

#include "batten/batten.h"

#include <jansson.h>

/// @file
/// The library behind one call for JavaScript: names, options and reports are JSON, arrays are pointers into the memory that
/// both sides share.
///
/// JavaScript puts arrays into memory from engine_allocate(), makes objects of them, runs operations on objects and reads
/// the result by its report, a JSON text in which the key "" marks arrays: {"": [type, address, count]}.

/// The most objects an operation takes.
#define ENGINE_INPUTS 2

/// The content of an object.
typedef enum engine_kind
{
    ENGINE_VALUES, ///< numbers and arrays of the report alone
    ENGINE_CURVES,
    ENGINE_MESH,
    ENGINE_POLYGONS,
    ENGINE_CLOUD,
    ENGINE_SURFACE, ///< a spline surface with its report
    ENGINE_SHELL
} engine_kind;

/// Arrays that an object owns beside its curves or its mesh.
#define ENGINE_ARRAYS 4

/// What an operation takes and gives.
typedef struct engine_object
{
    engine_kind kind;
    bat_curve_set set;          ///< ENGINE_CURVES
    bat_mesh mesh;              ///< ENGINE_MESH
    bat_cloud cloud;            ///< ENGINE_CLOUD
    bat_surface_result surface; ///< ENGINE_SURFACE
    bat_shell shell;            ///< ENGINE_SHELL
    void *arrays[ENGINE_ARRAYS];
    size_t array_count;
    json_t *report;
    char *text; ///< the report as text, once it was asked for
} engine_object;

/// The arguments of an operation.
typedef struct engine_call
{
    const json_t *options;                ///< a JSON object, or null
    engine_object *inputs[ENGINE_INPUTS]; ///< null beyond those that were given
    const void *bytes;                    ///< of readers: the file; of samplings: doubles
    size_t size;
} engine_call;

/// An operation. It fills `result`, whose report is an empty JSON object before.
typedef bat_status (*engine_operation)(const engine_call *call, engine_object *result, bat_error *error);

/// A row of the table of operations.
typedef struct engine_row
{
    const char *name;
    engine_operation run;
    engine_kind inputs[ENGINE_INPUTS]; ///< ENGINE_VALUES: none
    engine_kind result;
} engine_row;

/// Each ends with a null name.
extern const engine_row ENGINE_CURVE_ROWS[], ENGINE_MESH_ROWS[], ENGINE_MOTION_ROWS[], ENGINE_SURFACE_ROWS[];

/// How an option is stored.
typedef enum engine_type
{
    ENGINE_SIZE,
    ENGINE_INT,
    ENGINE_UINT64,
    ENGINE_NUMBER,
    ENGINE_BOOL,
    ENGINE_TEXT,  ///< a pointer to a text of the JSON object
    ENGINE_CHOICE ///< an enumeration, by its name
} engine_type;

/// An option: a field of a struct of the library.
typedef struct engine_option
{
    const char *name;
    size_t offset;
    engine_type type;
    const bat_family *family; ///< ENGINE_CHOICE
} engine_option;

/// The row of a field of the same name.
#define ENGINE_OPTION(type, field, kind)                                                                                    \
    {                                                                                                                       \
#field, offsetof(type, field), kind, NULL                                                                           \
    }
#define ENGINE_OPTION_CHOICE(type, field, family)                                                                           \
    {                                                                                                                       \
#field, offsetof(type, field), ENGINE_CHOICE, family                                                                \
    }
#define ENGINE_COUNT(table) (sizeof(table) / sizeof *(table))

/// Store the options of a JSON object in a struct. Each name that is no option is an error, but for `also`, a list of names
/// that ends with null.
bat_status engine_options(const json_t *json, const engine_option *options, size_t count, const char *const *also,
                          void *target, bat_error *error);
/// Refuse every option but those of a list that ends with null.
bat_status engine_no_options(const json_t *json, const char *const *also, bat_error *error);
/// Store the enumerator that a text names; nothing where it is null.
bat_status engine_choice(const bat_family *family, const char *name, void *value, bat_error *error);
/// The text of an option, or null where it is not given.
bat_status engine_text(const json_t *json, const char *name, const char **text, bat_error *error);

/// Fill an error.
bat_status engine_fail(bat_error *error, bat_status status, const char *text, const char *name);

/// @name Reports
/// @{

/// A number, also one that is not finite, which JSON does not have: then {"": "NaN"}, or Infinity or -Infinity.
json_t *engine_number(double value);
json_t *engine_size(size_t value);
/// {"": [type, address, count]}; null for a null pointer.
json_t *engine_array(const char *type, const void *data, size_t count);
json_t *engine_numbers(const double *values, size_t count);
void engine_set(json_t *object, const char *name, json_t *value);
/// Set a measure by its name; `base` is the struct that it is a field of.
void engine_measure(json_t *object, const bat_measure *measure, const void *base);
/// Set the arrays of a mesh as its fields; the object owns the mesh.
void engine_set_mesh(json_t *report, bat_mesh *mesh, bool polygons);
/// Set the points, boundary and triangles of a cloud.
void engine_set_cloud(json_t *report, const bat_cloud *cloud);
/// Memory that lives as long as the object.
void *engine_own(engine_object *object, void *memory);
/// @}

/// The progress function of all operations.
extern const bat_progress ENGINE_PROGRESS;

#endif
