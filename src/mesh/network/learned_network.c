#include "mesh/network/learned_network.h"

#include <assert.h>
#include <stdio.h>

enum
{
    W = LEARNED_WIDTH,
    X = LEARNED_EDGE_FEATURES,
    CONTEXT = LEARNED_CONTEXT
};

/// The first coefficient of an edge weighs the butterfly's candidate: from -1/2 to 3/2.
const learned_bound learned_vertex_bound[LEARNED_VERTEX_CANDIDATES] = {{0, (real)0.75}, {0, (real)0.75}, {0, (real)0.5},
                                                                       {0, (real)0.5},  {0, (real)0.5},  {0, (real)0.5}};
const learned_bound learned_edge_bound[LEARNED_EDGE_CANDIDATES] = {{(real)0.5, 1}, {0, (real)0.5},  {0, (real)0.5},
                                                                   {0, (real)0.5}, {0, (real)0.75}, {0, (real)0.75},
                                                                   {0, (real)0.5}, {0, (real)0.5},  {0, (real)0.5}};

/// A parameter of a level: columns 0 for a bias.
typedef struct shape
{
    const char *name;
    size_t rows, columns;
} shape;

static const shape SHAPES[LEARNED_LEVEL_PARAMETERS] = {
    [LEARNED_VERTEX_IN] = {"vertex_in.weight", W, LEARNED_VERTEX_INPUTS},
    [LEARNED_VERTEX_IN_BIAS] = {"vertex_in.bias", W, 0},
    [LEARNED_VERTEX_HIDDEN] = {"vertex_hidden.weight", W, W},
    [LEARNED_VERTEX_HIDDEN_BIAS] = {"vertex_hidden.bias", W, 0},
    [LEARNED_MESSAGE_SELF] = {"message_self.weight", W, W},
    [LEARNED_MESSAGE_SELF_BIAS] = {"message_self.bias", W, 0},
    [LEARNED_MESSAGE_RING] = {"message_ring.weight", W, W},
    [LEARNED_MESSAGE_EDGE] = {"message_edge.weight", W, X},
    [LEARNED_RING_LAST] = {"ring_last.weight", LEARNED_RINGS, W},
    [LEARNED_RING_LAST_BIAS] = {"ring_last.bias", LEARNED_RINGS, 0},
    [LEARNED_UPDATE_SELF] = {"update_self.weight", W, W},
    [LEARNED_UPDATE_MESSAGE] = {"update_message.weight", W, W},
    [LEARNED_UPDATE_BIAS] = {"update.bias", W, 0},
    [LEARNED_VERTEX_OUT] = {"vertex_out.weight", W, W},
    [LEARNED_VERTEX_OUT_BIAS] = {"vertex_out.bias", W, 0},
    [LEARNED_VERTEX_LAST] = {"vertex_last.weight", LEARNED_VERTEX_CANDIDATES, W},
    [LEARNED_VERTEX_LAST_BIAS] = {"vertex_last.bias", LEARNED_VERTEX_CANDIDATES, 0},
    [LEARNED_EDGE_END] = {"edge_end.weight", W, W},
    [LEARNED_EDGE_OPPOSITE] = {"edge_opposite.weight", W, W},
    [LEARNED_EDGE_OWN] = {"edge_own.weight", W, X},
    [LEARNED_EDGE_OWN_BIAS] = {"edge_own.bias", W, 0},
    [LEARNED_EDGE_HIDDEN] = {"edge_hidden.weight", W, W},
    [LEARNED_EDGE_HIDDEN_BIAS] = {"edge_hidden.bias", W, 0},
    [LEARNED_EDGE_LAST] = {"edge_last.weight", LEARNED_EDGE_CANDIDATES, W},
    [LEARNED_EDGE_LAST_BIAS] = {"edge_last.bias", LEARNED_EDGE_CANDIDATES, 0},
    [LEARNED_CONTEXT_UPDATE] = {"context_update.weight", W, CONTEXT},
    [LEARNED_CONTEXT_VERTEX] = {"context_vertex.weight", W, CONTEXT},
    [LEARNED_CONTEXT_EDGE] = {"context_edge.weight", W, CONTEXT},
};

bat_status mesh_learned_make(learn_parameters *parameters, bat_error *error)
{
    char name[LEARN_NAME_SIZE];
    for (size_t level = 0; level < LEARNED_LEVELS_OF_MESH; level++)
        for (size_t p = 0; p < LEARNED_LEVEL_PARAMETERS; p++)
        {
            const shape *s = &SHAPES[p];
            // Later levels get the states of the level before.
            size_t more = level > 0 && p == LEARNED_VERTEX_IN ? W : 0;
            (void)snprintf(name, sizeof name, "level.%zu.%s", level, s->name);
            (void)learn_parameters_add(parameters, s->columns > 0 ? s->rows : 0,
                                       s->columns > 0 ? s->columns + more : s->rows, name);
        }
    (void)learn_parameters_add(parameters, LEARNED_POOL, 2 * W, "pool.weight");
    (void)learn_parameters_add(parameters, 0, LEARNED_POOL, "pool.bias");
    bat_status status = learn_parameters_allocate(parameters, error);
    assert(status != BAT_OK || parameters->count == LEARNED_PARAMETERS);
    return status;
}
