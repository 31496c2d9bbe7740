#ifndef BATTEN_MESH_MEASURE_H
#define BATTEN_MESH_MEASURE_H

#include "batten/mesh.h"

BAT_C_BEGIN

/// @file
/// Measures of meshes: distances between two meshes, closest points, and a summary of one mesh.
///
/// The surface of a mesh is its faces: vertices without a face do not belong to it. Faces may be degenerate, and edges may
/// have more than two faces; only bat_mesh_check() must pass. Coordinates may have any size up to DBL_MAX / 4. Distances
/// below 1e-150 of the largest coordinate count as 0.

/// The default number of samples on a surface: enough for means and Hausdorff distances to 3 digits.
#define BAT_MESH_SAMPLES ((size_t)200000)

/// Options of comparisons. Begin with bat_mesh_compare_defaults().
typedef struct bat_mesh_compare_options
{
    /// Measure from the vertices alone, all of equal weight, instead of from the whole surface. Default false.
    bool vertices;
    /// The approximate number of samples on the faces of each mesh, in proportion to area but at least three a face; default
    /// BAT_MESH_SAMPLES.
    size_t samples;
    /// The relative accuracy of the greatest distance. The search ends when no distance can exceed the greatest found by
    /// more than this share of it, or of a millionth of the diagonal. 0: only vertices and samples are searched. Default
    /// 1e-4.
    double tolerance;
    int threads; ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_mesh_compare_options;

/// The options' default values.
BAT_API bat_mesh_compare_options bat_mesh_compare_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_mesh_compare_fields;

/// Distances between two meshes. A point's distance is that to the closest point of the other mesh's surface.
typedef struct bat_mesh_distance
{
    double hausdorff_from_first;  ///< the greatest distance of a point of the first mesh from the second
    double hausdorff_from_second; ///< the greatest distance of a point of the second mesh from the first
    double hausdorff;             ///< the greater of the two
    /// Proven: no point of either mesh is farther from the other than this. Infinite when only vertices are measured.
    double hausdorff_bound;
    double mean_from_first;         ///< the mean over the first mesh's area (Metro's E_m)
    double mean_from_second;        ///< the mean over the second mesh's area
    double mean;                    ///< half the sum of the two
    double mean_max;                ///< the greater of the two, which Metro calls the symmetric one
    double rms_from_first;          ///< root of the mean square over the first mesh's area
    double rms_from_second;         ///< root of the mean square over the second mesh's area
    double farthest_from_first[3];  ///< a point of the first mesh at hausdorff_from_first
    double farthest_from_second[3]; ///< a point of the second mesh at hausdorff_from_second
    double diagonal;                ///< of the second mesh's bounding box, to relate distances to
} bat_mesh_distance;

/// Measure the distances between two surfaces: Cignoni, Rocchini and Scopigno, "Metro: measuring error on simplified
/// surfaces" (1998). Means are over samples that represent equal areas of their face. The greatest distance is first that
/// over vertices and samples. Triangles that may hold a greater one are then halved until none can, or `samples` points are
/// used up. The proven bound is hausdorff_bound. docs/measures.md describes the algorithm.
///
/// @param options null for the defaults
/// @return BAT_OK; the failures of bat_mesh_check() for either mesh, which the text names; BAT_INVALID_ARGUMENT (an option,
///         a mesh of no area unless only vertices are measured); BAT_INVALID_POINT (a coordinate beyond DBL_MAX / 4);
///         BAT_NO_MEMORY or BAT_CANCELLED; `distance` is untouched on failure
BAT_API bat_status bat_mesh_compare(const bat_mesh *first, const bat_mesh *second, const bat_mesh_compare_options *options,
                                    bat_mesh_distance *distance, bat_error *error);

/// The point of a mesh that is closest to another point.
typedef struct bat_mesh_closest_point
{
    bat_mesh_point at;
    double position[3];
    double distance;
} bat_mesh_closest_point;

/// Find the closest points of a mesh, exactly. Of several equally close ones any may come out, but the same for any number
/// of threads. Fastest when neighbouring queries lie near each other.
///
/// @param points  count x 3
/// @param threads 0: as many as OpenMP gives
/// @param closest receives `count` results
/// @return BAT_OK; what bat_mesh_check() returns; BAT_INVALID_POINT with the index of a point that is not finite or beyond
///         DBL_MAX / 4; BAT_NO_MEMORY; `closest` is untouched on failure
BAT_API bat_status bat_mesh_closest(const bat_mesh *mesh, const double *points, size_t count, int threads,
                                    bat_mesh_closest_point *closest, bat_error *error);

/// The distances of all vertices of one mesh, also of those without a face, from the surface of another, as for error
/// colours.
/// @param distances receives from->vertex_count distances
/// @return as bat_mesh_closest()
BAT_API bat_status bat_mesh_vertex_distances(const bat_mesh *from, const bat_mesh *onto, int threads, double *distances,
                                             bat_error *error);

/// The summary of a mesh. Lengths and areas that overflow are infinite.
typedef struct bat_mesh_summary
{
    size_t vertices;          ///< also those without a face
    size_t isolated_vertices; ///< without a face
    size_t edges;
    size_t faces;
    size_t components;        ///< of faces that share vertices
    size_t boundary_edges;    ///< edges of one face
    size_t boundary_loops;    ///< closed walks along boundary edges
    size_t nonmanifold_edges; ///< edges of more than two faces
    size_t reversed_edges;    ///< edges of two faces that run through them in the same direction
    size_t pinched_vertices;  ///< vertices at which several fans of faces meet
    size_t degenerate_faces;  ///< whose height is below 1e-14 of their longest edge
    int64_t euler;            ///< vertices with a face - edges + faces
    bool manifold;            ///< neither crowded edges nor pinched vertices
    bool oriented;            ///< no reversed edges, no crowded ones
    bool closed;              ///< no boundary
    int64_t genus;            ///< the sum over the components of a closed, oriented manifold; else -1
    double area;              ///< of all faces
    double volume;            ///< enclosed by a closed, oriented mesh, negative when it is inside out; else NaN
    double low[3], high[3];   ///< the box around all faces
    double diagonal;          ///< of the box
    double min_edge;          ///< length
    double mean_edge;         ///< length
    double max_edge;          ///< length
    double min_quality;       ///< 4 sqrt(3) area / (a^2 + b^2 + c^2): 1 of an equilateral face, 0 of a degenerate one
    double mean_quality;      ///< over the faces
    double min_angle;         ///< at a face's corner, radians
    double max_angle;         ///< at a face's corner, radians
    size_t min_valence;       ///< edges at a vertex that has a face
    size_t max_valence;       ///< edges at a vertex
    size_t min_quality_face;  ///< the first face of least quality
} bat_mesh_summary;

/// The measures of a mesh, in the order of a report.
/// @param meshes  1: the fields of bat_mesh_summary; 2: those of bat_mesh_distance
/// @param measure receives row `index` of the table
/// @return false past the last row
BAT_API bool bat_mesh_measures(size_t meshes, size_t index, bat_measure *measure);

/// Summarize a mesh in linear time.
/// @return BAT_OK, what bat_mesh_check() returns, or BAT_NO_MEMORY; `summary` is untouched on failure
BAT_API bat_status bat_mesh_summarize(const bat_mesh *mesh, bat_mesh_summary *summary, bat_error *error);

BAT_C_END

#endif
