#include "mesh_input.h"

bool mesh_format_argument(const arguments *given, const char *option, bat_mesh_format *format)
{
    bat_error error;
    const char *name = argument(given, option);
    if (name == NULL || bat_mesh_format_by_name(name, format, &error) == BAT_OK)
        return true;
    (void)usage_error(given, "%s", error.text);
    return false;
}

bat_status mesh_input_read(const char *path, const bat_mesh_read_options *options, bool repair,
                           bat_mesh_repair_report *repairs, bat_mesh *mesh, bat_error *error)
{
    bat_mesh_read_options changed = *options;
    changed.keep_degenerate = repair;
    bat_mesh read;
    bat_status status = bat_mesh_read(path, &changed, &read, error);
    if (status != BAT_OK)
        return status;
    if (!repair)
    {
        *mesh = read;
        return BAT_OK;
    }
    status = bat_mesh_repair(&read, repairs, mesh, error);
    bat_mesh_free(&read);
    return status;
}

size_t mesh_input_repaired(const bat_mesh_repair_report *repairs)
{
    return repairs->degenerate_faces + repairs->duplicate_faces + repairs->flipped_faces + repairs->crowded_edges +
           repairs->opposed_edges + repairs->split_vertices;
}
