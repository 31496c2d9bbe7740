#include "byte_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bat_mesh_refine_options take_options(byte_reader *reader, double **normals)
{
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = (bat_mesh_scheme)take_choice(reader, 7);
    options.then = (bat_mesh_scheme)take_choice(reader, 7);
    options.levels = take_below(reader, 4);
    options.threads = 1;
    options.max_memory = (size_t)64 << 20;
    unsigned flags = take_byte(reader);
    options.limit = (flags & 1) != 0;
    options.limit_normals = (flags & 6) == 6 ? normals : NULL;
    options.fairness = (flags & 24) == 24 ? take_option(reader, 0, 1) : options.fairness;
    options.crease_angle = (flags & 32) != 0 ? take_option(reader, 0, 3.2) : options.crease_angle;
    options.tolerance = (flags & 64) != 0 ? take_option(reader, 0, 2) : 0;
    options.max_edge = (flags & 128) != 0 ? take_option(reader, 0, 8) : 0;
    options.rules.boundary = (bat_mesh_boundary)take_choice(reader, 4);
    options.rules.creasing = (bat_mesh_creasing)take_choice(reader, 3);
    options.rules.linear = (bat_mesh_linear)take_choice(reader, 7);
    return options;
}

/// A refined mesh passes the check of meshes; most broken ones are repaired before.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    byte_reader reader = {data, size};
    double *normals = NULL;
    bat_mesh_refine_options options = take_options(&reader, &normals);
    bool broken = take_byte(&reader) > 240;
    bat_mesh coarse = take_mesh(&reader, 14, 20, true), fine = {0};
    size_t fallback;
    bat_error error = {0};
    if (broken || coarse.offsets != NULL || repair(&coarse))
    {
        bat_status status = bat_mesh_refine(&coarse, &options, &fine, &fallback, &error);
        PROMISE(status == error.status && status != BAT_NO_MEMORY && status != BAT_CANCELLED);
        if (status == BAT_OK)
            PROMISE(bat_mesh_check(&fine, NULL) == BAT_OK);
    }
    free(normals);
    bat_mesh_free(&fine);
    bat_mesh_free(&coarse);
    return 0;
}
