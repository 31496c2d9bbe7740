#include "byte_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bat_mesh_decimate_options take_options(byte_reader *reader, double *distance)
{
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    unsigned flags = take_byte(reader);
    options.threads = 1;
    options.method = (bat_mesh_decimate_method)take_choice(reader, 4);
    options.vertices = (flags & 1) != 0 ? take_below(reader, 40) : options.vertices;
    options.faces = (flags & 2) != 0 ? take_below(reader, 60) : options.faces;
    options.ratio = (flags & 4) != 0 ? take_option(reader, 0, 1) : options.ratio;
    options.tolerance = (flags & 8) != 0 ? take_option(reader, 0, 4) : options.tolerance;
    options.relative_tolerance = (flags & 16) != 0;
    options.distance = (flags & 32) != 0 ? distance : NULL;
    options.candidates = (flags & 64) != 0 ? take_below(reader, 6) : options.candidates;
    options.seed = take_byte(reader);
    if ((flags & 128) == 0)
        return options;
    options.min_normal = take_option(reader, -1, 1);
    options.min_quality = take_option(reader, 0, 1);
    options.boundary_weight = take_option(reader, 0, 100);
    options.attributes = take_option(reader, 0, 10);
    return options;
}

/// The map of a decimation takes points there and back, each onto a face.
static void use_map(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, byte_reader *reader)
{
    bat_mesh_point points[8];
    size_t count = sizeof points / sizeof *points;
    for (size_t i = 0; i < count; i++)
    {
        double a = (double)take_byte(reader) / 255, b = (1 - a) * (double)take_byte(reader) / 255;
        points[i] = (bat_mesh_point){(uint32_t)take_below(reader, coarse->face_count), {a, b, 1 - a - b}};
    }
    if (bat_mesh_map_to_fine(map, points, count, NULL) != BAT_OK)
        return;
    for (size_t i = 0; i < count; i++)
        PROMISE(points[i].face < fine->face_count);
    if (bat_mesh_map_to_coarse(map, points, count, NULL) == BAT_OK)
        for (size_t i = 0; i < count; i++)
            PROMISE(points[i].face < coarse->face_count);
    bat_mesh refined = {0};
    if (bat_mesh_map_transfer(map, fine, coarse, 1, &refined, NULL) == BAT_OK)
        PROMISE(bat_mesh_check(&refined, NULL) == BAT_OK);
    bat_mesh_free(&refined);
}

/// A decimated mesh can be connected as the given one can.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    byte_reader reader = {data, size};
    double distance;
    bat_mesh_decimate_options options = take_options(&reader, &distance);
    bool broken = take_byte(&reader) > 240, mapped = take_flag(&reader);
    bat_mesh fine = take_mesh(&reader, 40, 60, false), coarse = {0};
    bat_mesh_map *map = NULL;
    bat_mesh_connectivity connectivity;
    bat_error error = {0};
    if (broken || repair(&fine))
    {
        bat_status status = bat_mesh_decimate(&fine, &options, &coarse, mapped ? &map : NULL, &error);
        PROMISE(status == error.status && status != BAT_NO_MEMORY && status != BAT_CANCELLED);
        if (status == BAT_OK)
        {
            PROMISE(bat_mesh_connect(&coarse, &connectivity, NULL) == BAT_OK);
            bat_mesh_connectivity_free(&connectivity);
            PROMISE(coarse.face_count <= fine.face_count);
            if (map != NULL)
                use_map(map, &fine, &coarse, &reader);
        }
    }
    bat_mesh_map_free(map);
    bat_mesh_free(&coarse);
    bat_mesh_free(&fine);
    return 0;
}
