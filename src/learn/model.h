#pragma once

#include "learn/parameters.h"

/// @file
/// Models: networks with the weights of a safetensors file, or with those that the library holds. Each subject has a table
/// of the networks that its files may hold.

/// The content of a file in which a network was found.
typedef struct learn_source
{
    const safetensors *content;
    const char *prefix; ///< of the arrays' names: a checkpoint holds more than one set of weights
} learn_source;

/// A network, one row of a table.
typedef struct learn_network
{
    const char *array;  ///< an array of the network; files of other networks lack it, unless they have recipes
    const char *recipe; ///< the beginning of the note "recipe" of its files, up to a comma; null: the array identifies them
    const void *rule;   ///< the functions that apply the network, of a type that its subject defines

    /// Name and shape the weights of `parameters`, which is empty, and allocate it with zeros.
    /// @param source null for the usual variant of the network
    /// @return BAT_OK or BAT_NO_MEMORY, with nothing to release on failure
    bat_status (*make)(const learn_source *source, learn_parameters *parameters, bat_error *error);
    /// Prepare weights for inference.
    /// @param network receives the argument of the rule; release it with free()
    /// @return BAT_OK or BAT_NO_MEMORY
    bat_status (*pack)(const learn_source *source, const learn_parameters *parameters, void **network, bat_error *error);
    /// Does nothing to null.
    void (*free)(void *network);
} learn_network;

/// The networks of a subject, and the weights that the library holds.
typedef struct learn_networks
{
    const learn_network *const *rows;
    size_t count;
    const safetensors *builtin;
} learn_networks;

/// A model of any subject; a subject's own type begins with it.
typedef struct learn_model
{
    const learn_network *kind;
    void *network;
} learn_model;

/// Read a model; of a checkpoint, the best weights. A file without an array of any row is read as one of the last row, so
/// that the error names what it lacks.
/// @param path  null: the weights that the library holds
/// @param size  of the subject's type; what follows the learn_model is zero
/// @param model receives the model; release it with learn_model_free()
/// @return BAT_OK; BAT_BAD_FILE (no network, an array that is missing, has another shape, or holds a number that is not
///         finite); BAT_FILE_ACCESS, BAT_UNSUPPORTED or BAT_NO_MEMORY; `*model` is untouched on failure
bat_status learn_model_read(const learn_networks *networks, const char *path, size_t size, learn_model **model,
                            bat_error *error);
/// The pack() of a network whose rule reads the weights as parameters->values has them.
bat_status learn_model_copy(const learn_source *source, const learn_parameters *parameters, void **network,
                            bat_error *error);
/// Does nothing to null.
void learn_model_free(learn_model *model);
