#include "byte_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// Distances and fairness of two curves of one space.
static void measure_curves(byte_reader *reader)
{
    bat_space space = take_space(reader);
    bat_curve_measure_options options = bat_curve_measure_defaults();
    options.threads = 1;
    options.geodesic = take_flag(reader);
    options.to_segments = take_flag(reader);
    options.bending_offset = take_flag(reader) ? take_option(reader, 0, 1) : options.bending_offset;
    bat_curve first = take_curve(reader, &space, 30), second = take_curve(reader, &space, 30);
    bat_curve_distance distance;
    bat_curve_fairness_values fairness;
    bool simple;
    if (bat_curve_compare(&first, &second, &options, &distance, NULL) == BAT_OK)
        PROMISE(distance.hausdorff >= distance.mean_nn * 0.999999 || distance.hausdorff == 0);
    (void)bat_curve_fairness(&first, &options, &fairness, NULL);
    (void)bat_curve_is_simple(&first, &simple, NULL);
    bat_curve_summary summary;
    (void)bat_curve_summarize(first.points, first.count * space.point_dim, &summary, NULL);
    bat_curve_free(&first);
    bat_curve_free(&second);
}

/// Distances of two meshes, and a summary.
static void measure_meshes(byte_reader *reader)
{
    bat_mesh_compare_options options = bat_mesh_compare_defaults();
    options.threads = 1;
    options.vertices = take_flag(reader);
    options.samples = take_below(reader, 300);
    options.tolerance = take_flag(reader) ? take_option(reader, 0, 1) : options.tolerance;
    bat_mesh first = take_mesh(reader, 20, 20, false), second = take_mesh(reader, 20, 20, false);
    bat_mesh_distance distance;
    bat_mesh_summary summary;
    if (bat_mesh_compare(&first, &second, &options, &distance, NULL) == BAT_OK)
        PROMISE(distance.hausdorff_bound >= distance.hausdorff && distance.hausdorff >= distance.mean_from_first * 0.999999);
    if (bat_mesh_summarize(&first, &summary, NULL) == BAT_OK)
        PROMISE(summary.faces == first.face_count && summary.area >= 0);
    double points[9], distances[20];
    bat_mesh_closest_point closest[3];
    for (size_t i = 0; i < 9; i++)
        points[i] = take_coordinate(reader);
    if (bat_mesh_closest(&first, points, 3, 1, closest, NULL) == BAT_OK)
        for (size_t i = 0; i < 3; i++)
            PROMISE(closest[i].at.face < first.face_count);
    (void)bat_mesh_vertex_distances(&second, &first, 1, distances, NULL);
    bat_mesh_free(&first);
    bat_mesh_free(&second);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    byte_reader reader = {data, size};
    if (take_flag(&reader))
        measure_curves(&reader);
    else
        measure_meshes(&reader);
    return 0;
}
