#include "byte_reader.h"

#include "batten/research/curve_analysis.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// Analyze a mask within seconds.
static void analyze(const bat_mask *mask)
{
    bat_mask_analyze_options options = bat_mask_analyze_defaults();
    bat_analysis analysis;
    bat_basis basis;
    bat_mask_stencil stencil;
    options.depth = 3;
    options.vertices = 40;
    if (mask->count > 12)
        return;
    if (bat_mask_analyze(mask, &options, &analysis, NULL) == BAT_OK)
    {
        PROMISE(!(analysis.radius_lower > analysis.radius_upper * 1.000001));
        bat_analysis_free(&analysis);
    }
    if (bat_mask_basis(mask, 2, &basis, NULL) == BAT_OK)
        bat_basis_free(&basis);
    (void)bat_mask_limit_stencil(mask, &stencil, NULL);
}

/// The first line is the name of a scheme; the rest is a curve that it refines.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char name[200];
    const uint8_t *end = size > 0 ? memchr(data, '\n', size) : NULL;
    size_t length = end != NULL ? (size_t)(end - data) : size;
    if (length >= sizeof name)
        return 0;
    memcpy(name, data, length);
    name[length] = '\0';
    bat_curve_scheme scheme;
    bat_motion_curves_options motion = bat_motion_curves_defaults();
    (void)bat_motion_scheme_by_name(name, &motion, NULL);
    if (bat_curve_scheme_by_name(name, &scheme, NULL) != BAT_OK)
        return 0;
    PROMISE(bat_curve_scheme_check(&scheme, NULL) != BAT_NO_MEMORY);
    if (scheme.kind == BAT_CURVE_SCHEME_KIND_LINEAR)
        analyze(&scheme.mask);
    byte_reader reader = {data + length, size - length};
    bat_space space = take_space(&reader);
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.scheme = scheme;
    options.levels = 2;
    options.threads = 1;
    options.snap = take_flag(&reader);
    options.ends = (bat_curve_end_rule)take_choice(&reader, 4);
    bat_curve coarse = take_curve(&reader, &space, 10), fine = {0};
    if (bat_curve_refine(&coarse, &options, &fine, NULL) == BAT_OK)
        promise_points(&space, fine.points, fine.count);
    bat_curve_free(&fine);
    bat_curve_free(&coarse);
    return 0;
}
