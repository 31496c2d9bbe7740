#ifndef BATTEN_MESH_PICTURE_H
#define BATTEN_MESH_PICTURE_H

#include "batten/mesh_transfer.h"

BAT_C_BEGIN

/// @file
/// Shaded pictures of triangle meshes, side by side, with edges, boundaries and colours for values at the vertices.
///
/// The projection is orthographic, with light from over the viewer's left shoulder and ambient occlusion. PNG is the natural
/// format; SVG and PDF hold the same pixels with vector text.

/// One mesh of a picture. All zero but `mesh` is a sensible panel: smooth, without wires.
typedef struct bat_mesh_picture_panel
{
    const bat_mesh *mesh; ///< finite, at least one face; need not be manifold; never null. Polygons are cut into triangles,
                          ///< but only their own edges are drawn, and flat ones have their mean normal
    const char *title;    ///< UTF-8, beneath the panel; null or "" for none
    const double *values; ///< vertex_count numbers, shown as colours; NaN for none at a vertex; null: a uniform colour
    bool wires;           ///< draw the edges
    bool flat; ///< every face by its own normal, else smooth where neighbours' normals differ by less than 40 degrees
} bat_mesh_picture_panel;

/// The axis of space that points upwards.
typedef enum bat_mesh_up
{
    BAT_MESH_UP_AUTO, ///< the default: BAT_MESH_UP_Y
    BAT_MESH_UP_Y,    ///< as most meshes have it
    BAT_MESH_UP_Z,
    BAT_MESH_UP_X
} bat_mesh_up;

/// The axes by name.
extern BAT_API const bat_family bat_mesh_up_family;

/// Options of pictures. Begin with bat_mesh_picture_defaults().
typedef struct bat_mesh_picture_options
{
    double width;            ///< in points, up to 10000; 0: from the number of columns; default 0
    double height;           ///< in points, up to 10000; 0: from the content; default 0
    double pixels_per_point; ///< of the meshes, and of all in PNG, 0.1 to 20; default 2
    size_t columns;          ///< panels in a row; 0: up to four, evenly filled; default 0
    bool own_frames;         ///< every panel has its own view and scale, else a row shares them; default false
    bat_mesh_up up;          ///< default BAT_MESH_UP_Y
    double longitude;        ///< of the viewer, radians around the upward axis; NaN: automatic; default NaN
    double latitude;         ///< the same above the horizon, -pi/2 to pi/2; NaN: automatic; default NaN
    bool ambient_occlusion;  ///< ambient occlusion; default true
    bool boundaries;         ///< mark boundary edges; default true
    double value_low;        ///< the value of the first colour; NaN: the least value, 0 if positive; default NaN
    double value_high;       ///< the last colour's; NaN: the greatest value of all panels; default NaN
    const char *value_label; ///< UTF-8, beside the scale: the values and their unit; null or "" for none; default null
    const char *title;       ///< UTF-8, above the panels; null or "" for none; default null
    int threads;             ///< 0: as many as OpenMP gives; the picture does not depend on it; default 0
} bat_mesh_picture_options;

/// The options' default values.
BAT_API bat_mesh_picture_options bat_mesh_picture_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_mesh_picture_fields;

/// Draw meshes into a file, whose ending chooses the format: .png, .svg or .pdf, in small or capital letters. The file
/// appears whole or not at all; the same input gives the same bytes.
///
/// The automatic view looks from 18 degrees above, or 42 for flat meshes. Its longitude is 35 degrees beside the direction
/// in which the first mesh of the row is thinnest across the upward axis, on the side of the positive axes.
///
/// @param options null for the defaults
/// @return BAT_OK; BAT_INVALID_ARGUMENT for another ending, an option out of range, a text that is not UTF-8, or no room;
///         the failures of bat_mesh_check(), with the panel named; BAT_INVALID_POINT with the index of an infinite value;
///         BAT_TOO_LARGE for more than 10000 points of height, 32767 pixels across or 2^28 samples of a panel;
///         BAT_NO_MEMORY; BAT_FILE_ACCESS
BAT_API bat_status bat_mesh_picture_write(const char *path, const bat_mesh_picture_panel *panels, size_t count,
                                          const bat_mesh_picture_options *options, bat_error *error);

/// Write an image as PNG. The file appears whole or not at all.
/// @return BAT_OK, BAT_INVALID_ARGUMENT for an image without pixels, BAT_FILE_ACCESS or BAT_NO_MEMORY
BAT_API bat_status bat_mesh_image_write(const char *path, const bat_mesh_image *image, bat_error *error);

/// Read an image of a material: PNG by cairo; this, JPEG, WebP, TIFF and BMP by GDAL, where it is there.
/// @param uri  a data URI in base64, or a file in the folder of `mesh` or below
/// @param mesh the file of the mesh; null: only data URIs are read
/// @return BAT_OK, BAT_FILE_ACCESS, BAT_BAD_FILE, BAT_UNSUPPORTED or BAT_NO_MEMORY; `image` is untouched on failure
BAT_API bat_status bat_mesh_image_read(const char *uri, const char *mesh, bat_mesh_image *image, bat_error *error);

/// Put baked images into the materials of all faces, for writing to glTF: `material_json` and the labels' materials. Faces
/// without one get the material "baked". Where an atlas was made, the materials lose their own textures. The colours' bytes
/// are taken for sRGB, as they are shown. The vertices lose theirs, by which glTF would multiply them.
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_mesh_baked_attach(const bat_mesh_baked *baked, bat_mesh *mesh, bat_error *error);

BAT_C_END

#endif
