#ifndef RESEARCH_TRAIN_SURFACE_NETWORK_TAPE_H
#define RESEARCH_TRAIN_SURFACE_NETWORK_TAPE_H

#include "research/networks/bidgcn.h"
#include "research/networks/radius_graph.h"
#include "research/train/surface_sample.h"
#include "surface/network/chart_network.h"

/// @file
/// Networks that parameterize clouds, on a tape, for training; and the operations of the published one along the edges of
/// radius graphs, which store one bit per edge.

/// What training needs of a network, beside its kind.
typedef struct surface_network_tape
{
    const learn_network *kind;

    /// Draw the initial weights.
    void (*start)(learn_parameters *parameters, uint64_t seed);

    /// The network on a tape that began with its parameters. Cloud and boundary stay until the step has been differentiated;
    /// other data with that lifetime is on the tape (learn_tape_memory()). Called from several threads at once, each with
    /// its own tape.
    /// @param boundary cloud->boundary_count x 2
    /// @return interior points x 2
    learn_array *(*predict)(learn_tape *tape, const bat_cloud *cloud, const double *boundary);
    /// The loss of one cloud, 1 x 1. Null: surface_sample_residual(), the mean square of the least-squares residual.
    /// @param interior the result of predict()
    learn_array *(*loss)(learn_tape *tape, const surface_sample *sample, learn_array *interior);
} surface_network_tape;

extern const surface_network_tape surface_tape_published, surface_tape_uninformed, surface_tape_batten;

/// Backpropagate through surface_chart_move(). Clamping to [0, 1] is ignored.
/// @param by_interior count x 2: derivatives with respect to `interior`
/// @param by_moves    CHART_MOVES numbers, to which the derivatives are added
void surface_chart_move_back(const surface_chart *chart, const double *moves, const double *by_interior, double *by_moves);

/// The numbers of neighbours in the graphs of the published network: interior, boundary, then the hidden layers'.
typedef struct surface_edges
{
    size_t count[2 + SURFACE_HIDDEN];
} surface_edges;

/// predict() of the published network. The tape's parameters determine its form.
/// @param edges may be null
learn_array *surface_network_predict(learn_tape *tape, const bat_cloud *cloud, const double *boundary, surface_edges *edges);

// Operations

/// The sources near each target.
typedef struct tape_graph
{
    size_t targets, sources, edges;
    size_t words;      ///< of a target
    uint64_t *bits;    ///< targets x words
    uint32_t *degrees; ///< of the targets
} tape_graph;

/// A graph that lives as long as the step. It has no derivative.
/// @param targets count x width
/// @param sources count x width, with width at most SURFACE_WIDTH
tape_graph tape_graph_make(learn_tape *tape, const learn_array *targets, const learn_array *sources, double radius);

/// Row i is the mean of the rows of x that are near row i.
/// @param x     R x SURFACE_WIDTH
/// @param graph of R targets and R sources, symmetric, each its own neighbour
learn_array *tape_graph_mean(learn_tape *tape, learn_array *x, const tape_graph *graph);

/// A linear layer, batch normalization over all edges and ReLU, averaged over neighbours: row i is the mean over the
/// neighbours j of max(0, normalized(x_i + y_j)), and 0 without neighbours.
/// @param x          targets x SURFACE_WIDTH
/// @param y          sources x SURFACE_WIDTH
/// @param gain,shift 1 x SURFACE_WIDTH
learn_array *tape_graph_messages(learn_tape *tape, learn_array *x, learn_array *y, learn_array *gain, learn_array *shift,
                                 const tape_graph *graph);

#endif
