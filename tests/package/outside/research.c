// A program that knows batten and batten-research only as installed packages. It passes a space of one library to the other:
// a space is recognized by its functions, so both must have the same ones.

#include <batten/batten.h>
#include <batten/research/research.h>

#include <stdio.h>

int main(void)
{
    const bat_space sphere = bat_sphere(2);
    bat_curve track = {0}, control = {0}, fine = {0};
    bat_mesh cage = {0};
    bat_error error = {.text = "no error"};
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.scheme = bat_curve_scheme_learned(0.5);
    options.levels = 2;
    bat_status status = bat_tension_iss_track(&sphere, &track, &control, &error);
    if (status == BAT_OK)
        status = bat_curve_refine(&control, &options, &fine, &error);
    if (status == BAT_OK)
        status = bat_mesh_shape("cage", 200, 1, &cage, &error);
    if (status == BAT_OK)
        status = bat_mesh_check(&cage, &error);
    if (status == BAT_OK)
        printf("%zu of %zu points become %zu\n", control.count, track.count, fine.count);
    else
        fprintf(stderr, "%s\n", error.text);
    bat_mesh_free(&cage);
    bat_curve_free(&fine);
    bat_curve_free(&control);
    bat_curve_free(&track);
    return status == BAT_OK ? 0 : 1;
}
