#include "byte_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// What welding, triangulation and repair give can be connected, and repair of it changes nothing.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    byte_reader reader = {data, size};
    double distance = take_option(&reader, 0, 2);
    unsigned flags = take_byte(&reader);
    bat_mesh mesh = take_mesh(&reader, 40, 60, true), made = {0};
    size_t merged;
    bat_mesh_repair_report report;
    bat_mesh_connectivity connectivity;
    if (bat_mesh_triangulate(&mesh, &made, NULL) == BAT_OK)
    {
        PROMISE(made.offsets == NULL && bat_mesh_check(&made, NULL) == BAT_OK);
        bat_mesh_free(&mesh);
        mesh = made;
    }
    if ((flags & 1) != 0 && bat_mesh_weld(&mesh, distance, &merged, &made, NULL) == BAT_OK)
    {
        PROMISE(made.vertex_count == mesh.vertex_count - merged);
        bat_mesh_free(&mesh);
        mesh = made;
    }
    if (bat_mesh_repair(&mesh, &report, &made, NULL) == BAT_OK)
    {
        PROMISE(bat_mesh_connect(&made, &connectivity, NULL) == BAT_OK);
        bat_mesh_connectivity_free(&connectivity);
        bat_mesh_free(&mesh);
        mesh = made;
        PROMISE(bat_mesh_repair(&mesh, &report, &made, NULL) == BAT_OK && bat_mesh_repair_places(&report) == 0);
        PROMISE(made.vertex_count == mesh.vertex_count && made.face_count == mesh.face_count);
        bat_mesh_free(&made);
    }
    bat_mesh_free(&mesh);
    return 0;
}
