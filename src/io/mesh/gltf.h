#pragma once

#include "batten/mesh_file.h"
#include "io/common/file_text.h"
#include "io/common/json.h"

/// @file
/// The structure of glTF 2.0 files (Khronos Group, "glTF 2.0 Specification", ISO/IEC 12113): JSON, buffers and accessors.

/// The types of numbers in buffers.
typedef enum gltf_type
{
    GLTF_INT8 = 5120,
    GLTF_UINT8 = 5121,
    GLTF_INT16 = 5122,
    GLTF_UINT16 = 5123,
    GLTF_UINT32 = 5125,
    GLTF_FLOAT = 5126
} gltf_type;

/// The marks of a GLB file and of its chunks.
enum
{
    GLB_MAGIC = 0x46546c67, ///< "glTF"
    GLB_JSON = 0x4e4f534a,  ///< "JSON"
    GLB_BIN = 0x004e4942,   ///< "BIN", zero
    GLB_VERSION = 2,
    GLB_HEADER = 12,
    GLB_CHUNK_HEADER = 8
};

/// The ways in which indices form faces.
enum
{
    GLTF_TRIANGLES = 4,
    GLTF_STRIP = 5,
    GLTF_FAN = 6
};

/// The bytes of a buffer.
typedef struct gltf_buffer
{
    const unsigned char *bytes; ///< null before the first use
    size_t size;
    char *owned; ///< the same where they belong to the document
} gltf_buffer;

/// An open file. All zero: closed.
typedef struct gltf_document
{
    const file_text *text;
    json_t *root;
    const unsigned char *chunk; ///< the binary chunk of GLB; null for none
    size_t chunk_size;
    gltf_buffer *buffers;
    size_t buffer_count;
    size_t total_size; ///< of the file and of the buffers so far
} gltf_document;

/// Parse a file and check its version and the extensions that it requires. `text` must outlive the document.
/// @return BAT_OK, BAT_BAD_FILE, BAT_UNSUPPORTED or BAT_NO_MEMORY; close the document also on failure
bat_status gltf_open(const file_text *text, gltf_document *document, bat_error *error);
void gltf_close(gltf_document *document);

/// A place in the document, for messages: "accessor 7".
typedef struct gltf_place
{
    const char *what;
    size_t index;
} gltf_place;

/// BAT_BAD_FILE for a place.
bat_status gltf_fault(gltf_place place, bat_error *error, const char *format, ...) __attribute__((format(printf, 3, 4)));

/// Read a whole number of 0 or more; `*value` stays where the member is missing.
/// @return BAT_OK or BAT_BAD_FILE for another value
bat_status gltf_size(const json_t *object, const char *key, gltf_place place, size_t *value, bat_error *error);
/// Read `count` finite numbers; `values` stay where the member is missing.
bat_status gltf_numbers(const json_t *object, const char *key, size_t count, gltf_place place, double *values,
                        bat_error *error);
/// An element of a root array by its number, or BAT_BAD_FILE. `what` is the singular of the array's name.
bat_status gltf_element(const gltf_document *document, const char *array, const char *what, size_t index, json_t **element,
                        bat_error *error);
/// The array of this name; null where it is missing.
/// @return BAT_OK, or BAT_BAD_FILE for another value
bat_status gltf_array(const json_t *object, const char *key, gltf_place place, const json_t **array, bat_error *error);

/// Read what a URI names: its own data, or a file in the folder of the file `own` or below it. free() releases `owned`.
bat_status gltf_bytes_read(const char *own, const char *uri, gltf_place place, gltf_buffer *buffer, bat_error *error);

/// The bytes of a buffer view.
typedef struct gltf_view
{
    const unsigned char *bytes;
    size_t size;
    size_t stride; ///< 0: none given
} gltf_view;

/// @return BAT_OK, BAT_BAD_FILE, BAT_FILE_ACCESS, BAT_UNSUPPORTED or BAT_NO_MEMORY
bat_status gltf_view_find(gltf_document *document, size_t index, gltf_view *view, bat_error *error);

/// What an accessor must be.
typedef struct gltf_wish
{
    size_t min_components, max_components; ///< 1 to 4
    bool whole;                            ///< unsigned whole numbers, as indices are
} gltf_wish;

/// The numbers of an accessor: normalized integers as fractions, sparse values inserted.
typedef struct gltf_values
{
    double *numbers; ///< count x components
    size_t count, components;
} gltf_values;

/// Read an accessor. Release the values with gltf_values_free().
/// @return as gltf_view_find(); `values` is untouched on failure
bat_status gltf_values_read(gltf_document *document, size_t index, const gltf_wish *wish, gltf_values *values,
                            bat_error *error);
void gltf_values_free(gltf_values *values);

/// A mesh in the scene.
typedef struct gltf_instance
{
    size_t node; ///< SIZE_MAX for a mesh without a node
    size_t mesh;
    double matrix[12]; ///< rows of the affine map from the mesh to the scene
} gltf_instance;

/// Find the meshes of the scene, in the order of its nodes.
/// @return BAT_OK, BAT_BAD_FILE (a cycle, a node with two parents) or BAT_NO_MEMORY
bat_status gltf_instances_find(const gltf_document *document, gltf_instance **instances, size_t *count,
                               bat_mesh_notes *notes, bat_error *error);

/// The materials' names, all different, and their definitions as JSON text (or null). Images become data URIs.
/// @param names receives `count` texts
/// @return as gltf_view_find(); the results are untouched on failure
bat_status gltf_materials_read(gltf_document *document, char ***names, size_t *count, char **json, bat_mesh_notes *notes,
                               bat_error *error);
