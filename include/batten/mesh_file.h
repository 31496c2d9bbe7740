#ifndef BATTEN_MESH_FILE_H
#define BATTEN_MESH_FILE_H

#include "batten/mesh_decimate.h"

BAT_C_BEGIN

/// @file
/// Readers and writers of meshes. docs/formats.md tells what each format holds.

/// The formats of meshes.
typedef enum bat_mesh_format
{
    /// Reading: by the signature of the content, else by the file's ending. Writing: by the file's ending.
    BAT_MESH_FORMAT_AUTO,
    BAT_MESH_FORMAT_OBJ,
    BAT_MESH_FORMAT_PLY,
    BAT_MESH_FORMAT_OFF,
    BAT_MESH_FORMAT_STL,
    BAT_MESH_FORMAT_GLTF, ///< glTF 2.0 as JSON; its buffers are written as data URIs. The reader takes GLB, too
    BAT_MESH_FORMAT_GLB,  ///< glTF 2.0 as a binary file. The reader takes JSON, too
    BAT_MESH_FORMAT_3MF   ///< 3MF, for 3D printing
} bat_mesh_format;

/// The formats by name.
extern BAT_API const bat_family bat_mesh_format_family;
/// The format of a file that holds a mesh: by its ending, else by its content. An OBJ file holds one where its first element
/// is a face, not a line. Only regular files are read.
/// @param format receives BAT_MESH_FORMAT_AUTO for a file that holds no mesh, or cannot be opened or read
/// @return BAT_OK, BAT_TOO_LARGE or BAT_NO_MEMORY
BAT_API bat_status bat_mesh_format_of_file(const char *path, bat_mesh_format *format, bat_error *error);

/// Remarks on what a file holds and a mesh cannot, or a mesh holds and a format cannot, and on guesses. All zero: none.
typedef struct bat_mesh_notes
{
    char **texts; ///< `count` texts of one line
    size_t count;
} bat_mesh_notes;

/// Free the notes; none are left.
BAT_API void bat_mesh_notes_free(bat_mesh_notes *notes);

/// Options of reading. Begin with bat_mesh_read_defaults().
typedef struct bat_mesh_read_options
{
    bat_mesh_format format; ///< default BAT_MESH_FORMAT_AUTO
    /// Refuse a mesh that is not as bat_mesh_connect() and its neighbours need it. Without it, the default, what is harmless
    /// is made right, with notes: polygons are cut as by bat_mesh_triangulate(), unless `polygons` keeps them; triangles
    /// that are no manifold go through bat_mesh_repair(); values that are not finite become 0. Default false.
    bool strict;
    bool triangulate; ///< cut polygons of more than three corners into triangles, as bat_mesh_triangulate(); default false
    /// Keep faces that have the same vertex twice, for bat_mesh_repair(), instead of refusing or dropping them; then only
    /// `repair` repairs. Default false.
    bool keep_degenerate;
    /// Repair all: drop vertices that are not finite and their faces, bat_mesh_weld(), bat_mesh_repair(). Default false.
    bool repair;
    size_t fill_holes;               ///< with it `repair`, then bat_mesh_fill_holes() of so many edges; 0: none, the default
    bat_mesh_repair_report *repairs; ///< receives what was repaired; may be null, the default
    bat_mesh_notes *notes;           ///< notes of a successful reading are appended; may be null, the default
    bool polygons; ///< keep polygons of more than three corners as they are, unless `triangulate` cuts them; default false
    /// bat_mesh_weld() triangles by this distance, before a repair. 0: do not. -1, the default: by 1e-7 of the diagonal,
    /// with `repair`, and where the file is STL, or not 3MF and every triangle has vertices of its own without values;
    /// without `repair` where no triangle loses a corner.
    double weld;
    bat_limits limits; ///< what is more is refused with BAT_TOO_LARGE; default: those of bat_limits
} bat_mesh_read_options;

/// The options' default values.
BAT_API bat_mesh_read_options bat_mesh_read_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_mesh_read_fields;

/// Read the mesh of a file: at least one face, finite numbers, faces of existing vertices. bat_mesh_connect() tells whether
/// the faces are a manifold.
///
/// @param path    "-" is standard input. Buffers of glTF are searched in the folder of the file and below it
/// @param options null for the defaults
/// @param mesh    receives the mesh; release it with bat_mesh_free()
/// @param error   `line` is the failing line in formats with lines; `index` the failing vertex or face of the file
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_UNSUPPORTED, BAT_FILE_ACCESS, BAT_BAD_FILE, BAT_TOO_LARGE or BAT_NO_MEMORY;
///         what bat_mesh_repair() and bat_mesh_fill_holes() return; `mesh` is untouched on failure
BAT_API bat_status bat_mesh_read(const char *path, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error);
/// The same from `size` bytes, which need no final zero. BAT_MESH_FORMAT_AUTO goes by the content.
BAT_API bat_status bat_mesh_read_memory(const void *bytes, size_t size, const bat_mesh_read_options *options, bat_mesh *mesh,
                                        bat_error *error);

/// The encoding of numbers in PLY and STL. OBJ and OFF are always text.
typedef enum bat_mesh_encoding
{
    BAT_MESH_ENCODING_AUTO,       ///< the default: BAT_MESH_ENCODING_BINARY
    BAT_MESH_ENCODING_BINARY,     ///< little-endian: doubles in PLY, single precision in STL
    BAT_MESH_ENCODING_BIG_ENDIAN, ///< the same with the greater bytes first; PLY only
    BAT_MESH_ENCODING_TEXT        ///< decimal numbers that bring back the same doubles
} bat_mesh_encoding;

/// The encodings by name.
extern BAT_API const bat_family bat_mesh_encoding_family;

/// Options of writing. Begin with bat_mesh_write_defaults().
typedef struct bat_mesh_write_options
{
    bat_mesh_format format;     ///< default BAT_MESH_FORMAT_AUTO
    bat_mesh_encoding encoding; ///< default BAT_MESH_ENCODING_BINARY
    int threads;                ///< 0: as many as OpenMP gives; the bytes do not depend on it; default 0
    bat_mesh_normals normals;   ///< vertex normals, in OBJ, PLY and glTF; default BAT_MESH_NORMALS_NONE
    /// vertex_count x 3 normals to write instead, such as those of bat_mesh_limit_normals(); null: none, the default. Zero
    /// normals become those of `normals`, or of BAT_MESH_NORMALS_ANGLE.
    const double *vertex_normals;
    bool tangents; ///< bat_mesh_tangents(), beside vertex normals and texture coordinates; glTF only; default false
    /// Coarser meshes of the same shape, the finest first: levels of detail of one node (MSFT_lod); glTF only. Default null.
    const bat_mesh *lods;
    size_t lod_count;            ///< default 0
    const double *lod_distances; ///< of `lods`, from the mesh, which `extras` tell; null: none, the default
    bat_mesh_notes *notes;       ///< notes of a successful writing are appended; may be null, the default
} bat_mesh_write_options;

/// The options' default values.
BAT_API bat_mesh_write_options bat_mesh_write_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_mesh_write_fields;

/// Write a mesh. The file appears whole or not at all; an existing one survives a failure. Formats of triangles get polygons
/// cut, which a note says.
///
/// @param path    "-" is standard output
/// @param mesh    a mesh that bat_mesh_check() accepts
/// @param options null for the defaults
/// @return BAT_OK; BAT_INVALID_ARGUMENT for an option out of range or an unknown ending without `format`; BAT_INVALID_POINT;
///         BAT_UNSUPPORTED (a number or a name that the format cannot hold); BAT_FILE_ACCESS, BAT_NO_MEMORY, or the
///         failures of bat_mesh_triangulate()
BAT_API bat_status bat_mesh_write(const char *path, const bat_mesh *mesh, const bat_mesh_write_options *options,
                                  bat_error *error);
/// The same to memory, in the format of the options: `bytes` receives `size` bytes and a final zero; release it with free().
BAT_API bat_status bat_mesh_write_memory(const bat_mesh *mesh, const bat_mesh_write_options *options, char **bytes,
                                         size_t *size, bat_error *error);

/// Write a map to a file, whole or not at all. The format is described in docs/algorithms/decimation.md.
/// @return BAT_OK, BAT_FILE_ACCESS, BAT_NO_MEMORY
BAT_API bat_status bat_mesh_map_write(const char *path, const bat_mesh_map *map, bat_error *error);

/// Read a map. Everything that carrying points relies on is checked.
///
/// @param fine, coarse the meshes it must belong to; null: not checked
/// @return BAT_OK, BAT_FILE_ACCESS, BAT_BAD_FILE, BAT_INVALID_ARGUMENT when it belongs to other meshes, BAT_NO_MEMORY
BAT_API bat_status bat_mesh_map_read(const char *path, const bat_mesh *fine, const bat_mesh *coarse, bat_mesh_map **map,
                                     bat_error *error);

BAT_C_END

#endif
