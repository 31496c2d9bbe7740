#ifndef BATTEN_MESH_TRANSFER_H
#define BATTEN_MESH_TRANSFER_H

#include "batten/mesh_decimate.h"

BAT_C_BEGIN

/// @file
/// From a fine mesh to its decimation, through the bijective map between both. Values and labels, an atlas for texture, and
/// images of normals, colours and occlusion go that way. docs/algorithms/decimation.md describes the algorithms.

/// Carry the fine mesh's channels and labels to the coarse one. Values are nearest in the mean square over the area of the
/// fine mesh, within the range of the values around. Each face gets the label with most area in it, where the coarse mesh
/// has the fine one's labels, as after bat_mesh_decimate(). Texture coordinates are transferred by
/// bat_mesh_map_transfer() where the coarse mesh has none.
///
/// @param coarse  its channels and its faces' labels are replaced
/// @param normals receives unit normals of the coarse mesh's vertices, carried from the fine one likewise; release them with
///                free(). Null: not wanted
/// @return BAT_OK, BAT_INVALID_ARGUMENT for a map of other meshes, BAT_TOO_LARGE or BAT_NO_MEMORY; results are untouched on
///         failure
BAT_API bat_status bat_mesh_transfer(const bat_mesh_map *map, const bat_mesh *fine, bat_mesh *coarse, double **normals,
                                     bat_error *error);

/// Options of an atlas. Begin with bat_mesh_unwrap_defaults().
typedef struct bat_mesh_unwrap_options
{
    size_t size;      ///< texels along a side of the image, 16 to 16384; default 1024
    size_t padding;   ///< the least number of texels around a chart, 1 to 64; default 4
    double max_angle; ///< between a face and the plane of its chart, 0.1 to 1.5 radians; default 0.8
} bat_mesh_unwrap_options;

/// The options' default values.
BAT_API bat_mesh_unwrap_options bat_mesh_unwrap_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_mesh_unwrap_fields;

/// Make texture coordinates from 0 to 1 in which faces do not overlap. Charts grow from face to face and are projected onto
/// the plane of their mean normal. They are packed by their outlines (Lévy et al., "Least squares conformal maps", 2002).
///
/// @param mesh   of triangles; receives the texture coordinates, in place of its own
/// @param charts receives the number of charts; may be null
/// @return BAT_OK; BAT_INVALID_ARGUMENT for an option or for charts that do not fit into the image; the failures of
///         bat_mesh_check() and bat_mesh_connect(); BAT_NO_MEMORY; `mesh` is untouched on failure
BAT_API bat_status bat_mesh_unwrap(bat_mesh *mesh, const bat_mesh_unwrap_options *options, size_t *charts, bat_error *error);

/// An image of three bytes a pixel (red, green, blue), the top row first. All zero: none.
typedef struct bat_mesh_image
{
    unsigned char *pixels;
    size_t width, height;
} bat_mesh_image;

/// Options of baking. Begin with bat_mesh_bake_defaults().
typedef struct bat_mesh_bake_options
{
    bat_mesh_unwrap_options unwrap; ///< the images' size and padding, and the atlas where one is made
    bool normal;                    ///< bake normals; default true
    bool colour;                    ///< bake the channels red, green and blue; default false
    bool occlusion;                 ///< bake ambient occlusion; default false
    size_t rays;                    ///< of occlusion, from each vertex of the fine mesh, 1 to 65536; default 64
    double distance;                ///< of occluders, as a share of the box's diagonal, above 0; default 0.25
    int threads;                    ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
} bat_mesh_bake_options;

/// The options' default values.
BAT_API bat_mesh_bake_options bat_mesh_bake_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_mesh_bake_fields;

/// Images that were baked. Release them with bat_mesh_baked_free().
typedef struct bat_mesh_baked
{
    bat_mesh_image normal, colour, occlusion; ///< no pixels where not wanted
    double *normals; ///< vertex_count x 3: the normals to shade the coarse mesh with, those of bat_mesh_transfer()
    size_t texels;   ///< with their centre in a face
    size_t charts;   ///< of the atlas that was made; 0: the mesh's own texture coordinates are used
    double max_turn; ///< the greatest angle between a texel's normal and that of the fine mesh, radians; 0 without normals
} bat_mesh_baked;

/// Bake images of the fine mesh, by the texture coordinates of the coarse one. Where it has none, or they overlap or leave
/// the unit square, an atlas is made. A texel shows the image of its centre under the map, so thin and folded parts do not
/// mix.
///
/// Normals are those of tangent space as in glTF: red along the tangent, green along the bitangent, upwards in the image.
/// Vertex normals are `normals`, tangents those that bat_mesh_write() writes on demand. As with MikkTSpace, interpolated
/// vectors are not normalized, and the bitangent is made in each texel. Tangents weigh faces by their angles.
///
/// @param coarse its texture coordinates may be replaced
/// @return BAT_OK; BAT_INVALID_ARGUMENT (an option, a map of other meshes, no colours); the failures of bat_mesh_unwrap();
///         BAT_NO_MEMORY; results are untouched on failure
BAT_API bat_status bat_mesh_bake(const bat_mesh_map *map, const bat_mesh *fine, bat_mesh *coarse,
                                 const bat_mesh_bake_options *options, bat_mesh_baked *baked, bat_error *error);
BAT_API void bat_mesh_baked_free(bat_mesh_baked *baked);

/// A source of colours, such as the images of materials.
typedef struct bat_mesh_painter
{
    /// Sets the colour of a point of the fine mesh in bytes of sRGB. Several threads call it.
    void (*paint)(const void *context, const bat_mesh_point *point, unsigned char colour[3]);
    const void *context; ///< handed to `paint`
} bat_mesh_painter;

/// bat_mesh_bake() with colours from a painter; null: from the channels.
BAT_API bat_status bat_mesh_bake_painted(const bat_mesh_map *map, const bat_mesh *fine, bat_mesh *coarse,
                                         const bat_mesh_bake_options *options, const bat_mesh_painter *painter,
                                         bat_mesh_baked *baked, bat_error *error);

/// A tangent for each corner: the direction in which the first texture coordinate grows, perpendicular to the vertex normal.
/// The fourth number is 1 or -1, the sign of the bitangent. Corners with the same vertex and texture coordinate have the
/// same tangent.
/// @param normals  vertex_count x 3
/// @param tangents receives face_count x 3 x 4 numbers; release them with free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT for no texture coordinates, or BAT_NO_MEMORY
BAT_API bat_status bat_mesh_tangents(const bat_mesh *mesh, const double *normals, double **tangents, bat_error *error);

/// Decimate a mesh to several shares of its faces, each from the one before, and measure each against the first.
///
/// @param shares    of the faces, from 1 down; 1 is the mesh itself
/// @param options   null for the defaults; their targets are not read
/// @param levels    receives `count` meshes, from bat_mesh_free()'s empty ones
/// @param distances receives for each the greatest distance of either surface from the other; may be null
/// @return BAT_OK; BAT_INVALID_ARGUMENT for shares that do not decrease from at most 1 to above 0; the failures of
///         bat_mesh_decimate() and bat_mesh_compare(); results are untouched on failure
BAT_API bat_status bat_mesh_lods(const bat_mesh *fine, const double *shares, size_t count,
                                 const bat_mesh_decimate_options *options, bat_mesh *levels, double *distances,
                                 bat_error *error);

BAT_C_END

#endif
