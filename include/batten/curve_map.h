#ifndef BATTEN_CURVE_MAP_H
#define BATTEN_CURVE_MAP_H

#include "batten/curve_set.h"

BAT_C_BEGIN

/// @file
/// Maps: curves that share borders, refined together so that the borders stay shared and nothing crosses.

/// Which sets of curves are maps.
typedef enum bat_curve_map_topology
{
    BAT_CURVE_MAP_TOPOLOGY_AUTO, ///< the default: BAT_CURVE_MAP_TOPOLOGY_FEATURES
    /// Sets whose file has features, such as GeoJSON, in the plane, on the sphere S^2 and in the disk.
    BAT_CURVE_MAP_TOPOLOGY_FEATURES,
    BAT_CURVE_MAP_TOPOLOGY_ALWAYS,  ///< All sets; those in other spaces share borders, and nothing tests whether they cross.
    BAT_CURVE_MAP_TOPOLOGY_SEPARATE ///< None: every curve by itself, bat_curves_refine().
} bat_curve_map_topology;

/// Which sets are maps, by name.
extern BAT_API const bat_family bat_curve_map_topology_family;

/// Which edges of a map on the sphere are straight in longitude and latitude, as those of files are (RFC 7946, 3.1.1).
typedef enum bat_curve_map_edges
{
    BAT_CURVE_MAP_EDGES_AUTO,     ///< the default: runs along parallels and meridians, longer than a degree, stay on them
    BAT_CURVE_MAP_EDGES_GEODESIC, ///< none: edges are geodesics
    BAT_CURVE_MAP_EDGES_STRAIGHT  ///< all runs longer than a degree
} bat_curve_map_edges;

/// Which edges are straight in degrees, by name.
extern BAT_API const bat_family bat_curve_map_edges_family;

/// Whether lines of a map that meet end to end go on.
typedef enum bat_curve_map_join
{
    BAT_CURVE_MAP_JOIN_AUTO, ///< the default: lines whose ends are in one point where no third is are refined as one
    BAT_CURVE_MAP_JOIN_NO    ///< every line is refined as one with ends
} bat_curve_map_join;

/// How lines of a map are joined, by name.
extern BAT_API const bat_family bat_curve_map_join_family;

/// What refinement of a map found and did.
typedef struct bat_curve_map_refine_report
{
    bool map;                       ///< whether the set was a map; all numbers but `curves` are 0 if not
    bat_curve_refine_report curves; ///< levels and corners; of a set that is no map, all
    size_t arcs;                    ///< polylines between nodes, and rings without nodes
    size_t shared;                  ///< arcs that belong to more than one curve
    size_t dropped;                 ///< points, see bat_curve_map_refine_options::simplify
    size_t joints;                  ///< pairs of line ends that were joined, see bat_curve_map_join
    size_t nodes;                   ///< vertices at which arcs end
    size_t given_crossing;          ///< pairs of given edges that cross or touch; what they become may do so, too
    size_t crossings;               ///< pairs of refined edges that crossed or touched, over all levels
    size_t drawn_back;              ///< edges whose new points were drawn back, over all levels
    size_t snapped;                 ///< vertices that were moved onto others or added to edges, see snap_tolerance
    size_t spikes;                  ///< vertices that were dropped from spikes of rings, edges that lead there and back
    double largest_snap;            ///< the longest way of a vertex
    double largest_area_error;      ///< of a ring, relative to its area, with keep_area; else 0
} bat_curve_map_refine_report;

/// Options of maps. Begin with bat_curve_map_refine_defaults().
typedef struct bat_curve_map_refine_options
{
    /// Of each arc. `simple`: BAT_CURVE_SIMPLE_NEVER lets arcs cross. `report`: not used.
    bat_curve_refine_options refine;
    bat_curve_map_topology topology; ///< default BAT_CURVE_MAP_TOPOLOGY_FEATURES
    bat_curve_map_edges edges;       ///< default BAT_CURVE_MAP_EDGES_AUTO
    bat_curve_map_join join;         ///< default BAT_CURVE_MAP_JOIN_AUTO; only with schemes that keep the given points
    /// Points nearer to each other than this become one, and points nearer to an edge become its vertices, in the unit of
    /// the space's distance. 0: only equal points are shared. Default 0.
    double snap_tolerance;
    /// Points are dropped first, by Douglas and Peucker's algorithm on each arc: none is farther than this from the edge in
    /// its place. Borders stay shared, and nothing crosses that did not. 0: none. Default 0.
    double simplify;
    bool keep_area; ///< rings keep the area of their polygons to 1e-6 of it; plane and sphere. Default false
    int decimals;   ///< of degrees on the sphere, 0 to 12: the rounded curves do not cross. Default 10, as in files
    bat_curve_map_refine_report *report; ///< receives what was done when the call succeeds. Default null
} bat_curve_map_refine_options;

/// The options' default values.
BAT_API bat_curve_map_refine_options bat_curve_map_refine_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_curve_map_refine_fields;

/// Refine a set of curves as a map. docs/algorithms/maps.md describes how.
///
/// The curves are cut into arcs at nodes: vertices where three or more edges meet, ends of open curves, and corners. Each
/// arc is refined once, so that a border of two polygons stays one: the same coordinates in both. Where refined arcs cross
/// or touch each other and the given edges do not, the new points are drawn back level by level until nothing meets. On the
/// sphere the test is made in longitude and latitude, rounded to options->decimals.
///
/// @param coarse  checked as by bat_curve_refine()
/// @param options null for the defaults
/// @param fine    receives one curve for each given one, with the attributes of `coarse`; release it with
///                bat_curve_set_free()
/// @param error   its `curve` is the failing one where it is known, its `index` the point of that curve
/// @return as bat_curve_refine(); BAT_UNSUPPORTED also where a scheme that does not keep the given points makes arcs cross,
///         and for BAT_CURVE_END_RULE_FREE. `fine` is untouched on failure
BAT_API bat_status bat_curve_map_refine(const bat_curve_set *coarse, const bat_curve_map_refine_options *options,
                                        bat_curve_set *fine, bat_error *error);

BAT_C_END

#endif
