#ifndef RESEARCH_TRAIN_MESH_PAIRS_H
#define RESEARCH_TRAIN_MESH_PAIRS_H

#include "batten/mesh.h"
#include "mesh/network/flap.h"

/// @file
/// The training data of rules for meshes: coarse meshes made from fine shapes by random decimation, with target positions
/// for the vertices of every level.

enum
{
    MESH_PAIR_MAX_LEVELS = 4
};

/// A coarse mesh and its refinements, in the shape's own coordinates. Release it with mesh_pair_free().
typedef struct mesh_pair
{
    bat_mesh coarse;
    mesh_levels levels;
    /// levels.count + 1 entries: vertices x 3 positions at each level, vertex for vertex. Level 0 is not the coarse mesh
    /// where the map moves its vertices.
    const double *target[MESH_PAIR_MAX_LEVELS + 1];
    /// Unit normals of the shape at the targets of the last level, of which those of the earlier levels are the first; null
    /// where the targets do not lie on the shape.
    const double *normals;
    double *memory; ///< holds targets and normals
} mesh_pair;

/// Options of a pair.
typedef struct mesh_pair_plan
{
    size_t levels;                     ///< 1 to MESH_PAIR_MAX_LEVELS
    size_t min_vertices, max_vertices; ///< of the coarse mesh, drawn uniformly
    double min_normal, min_quality;    ///< as in bat_mesh_decimate_options
    bool loop;                         ///< the targets are Loop's refinement of the coarse mesh instead of the shape
} mesh_pair_plan;

/// Make a pair by the semi-random decimation of Liu et al. (2020), appendix E: of 100 random edges the one of smallest
/// error.
/// @param shape what bat_mesh_check() and bat_mesh_connect() accept
/// @param seed  of all randomness
/// @return BAT_OK, what bat_mesh_decimate() and bat_mesh_refine() return; `pair` is untouched on failure
bat_status mesh_pair_make(const bat_mesh *shape, const mesh_pair_plan *plan, uint64_t seed, mesh_pair *pair,
                          bat_error *error);
void mesh_pair_free(mesh_pair *pair);

/// Many pairs, of which each epoch may replace some.
typedef struct mesh_pairs
{
    const bat_mesh *shapes; ///< the caller's
    size_t shape_count;
    mesh_pair_plan plan;
    uint64_t seed;
    size_t resampled;   ///< pairs that each epoch replaces, in cyclic order
    mesh_pair *pair;    ///< count; pair p is of shape p % shape_count
    uint64_t *made_for; ///< count: the epoch in which a pair was made, plus 1; 0: not yet
    size_t count;
} mesh_pairs;

/// Room for `count` pairs, which mesh_pairs_renew() makes. Release it with mesh_pairs_free().
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_pairs_begin(const bat_mesh *shapes, size_t shape_count, size_t count, const mesh_pair_plan *plan,
                            uint64_t seed, size_t resampled, mesh_pairs *pairs, bat_error *error);
/// Make the missing pairs of an epoch. They depend on the seed and the epoch alone, not on the epochs before.
/// @param wanted which, [count]; null for all
/// @return as mesh_pair_make(), or BAT_CANCELLED
bat_status mesh_pairs_renew(mesh_pairs *pairs, uint64_t epoch, const bool *wanted, int threads, bat_progress progress,
                            bat_error *error);
void mesh_pairs_free(mesh_pairs *pairs);

/// The epoch in which pair `p` of a later epoch was made. Epoch e > 0 replaces the pairs (e - 1) resampled … e resampled -
/// 1, modulo the count.
uint64_t mesh_pair_epoch(size_t count, size_t resampled, size_t p, uint64_t epoch);
/// The seed of pair `p` made in an epoch.
uint64_t mesh_pair_seed(uint64_t seed, size_t p, uint64_t epoch);

#endif
