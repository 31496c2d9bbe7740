#include "curve.h"

#include "report.h"

#include <stdlib.h>

/// Give layers the polygons of a set's curves.
static void set_polygons(const bat_curve_set *set, bat_curve_picture_layer *layers)
{
    for (size_t i = 0; i < set->count; i++)
    {
        size_t polygon;
        if (bat_curve_set_polygon(set, i, &polygon, &layers[i].feature))
            layers[i].polygon = polygon + 1;
    }
}

/// The layers of one panel: the control polygons, the truth when there is one, the refined curves unless the level is 0.
static size_t make_layers(const curve_job *job, const bat_curve_set *coarse, const bat_curve_set *truth,
                          const bat_curve_set *fine, size_t levels, bat_curve_picture_layer *layers)
{
    size_t count = 0;
    for (size_t i = 0; i < coarse->count; i++)
        layers[count++] = (bat_curve_picture_layer){
            .curve = &coarse->curves[i], .role = BAT_CURVE_LAYER_ROLE_CONTROL, .label = i == 0 ? "given" : NULL};
    set_polygons(coarse, layers);
    for (size_t i = 0; truth != NULL && i < truth->count; i++)
        layers[count++] = (bat_curve_picture_layer){
            .curve = &truth->curves[i], .role = BAT_CURVE_LAYER_ROLE_TRUTH, .label = i == 0 ? "truth" : NULL};
    for (size_t i = 0; levels > 0 && i < fine->count; i++)
        layers[count++] = (bat_curve_picture_layer){.curve = &fine->curves[i],
                                                    .role = BAT_CURVE_LAYER_ROLE_CURVE,
                                                    .label = i == 0 ? job->scheme : NULL,
                                                    .colour = 1};
    if (levels > 0)
        set_polygons(fine, layers + count - fine->count);
    return count;
}

/// What one picture is made of.
typedef struct panel_set
{
    size_t count;
    bat_curve_set fine[CURVE_MAX_PANELS]; ///< empty where the job's own result is shown
    bat_curve_picture_layer *layers[CURVE_MAX_PANELS];
    char titles[CURVE_MAX_PANELS][24];
    bat_curve_picture_panel panels[CURVE_MAX_PANELS];
} panel_set;

static int make_panel(curve_job *job, panel_set *set)
{
    const bat_curve_set *coarse = &job->coarse, *truth = job->truth != NULL ? &job->truths : NULL, *fine = &job->fine;
    size_t p = set->count++, levels = job->panel_count > 0 ? job->panels[p] : job->refine.levels;
    if (levels > 0 && levels != job->refine.levels)
    {
        int code = curve_refine(job, levels, &set->fine[p], NULL);
        if (code != EXIT_DONE)
            return code;
        fine = &set->fine[p];
    }
    set->layers[p] = calloc(2 * coarse->count + (truth != NULL ? truth->count : 0), sizeof *set->layers[p]);
    if (set->layers[p] == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    (void)snprintf(set->titles[p], sizeof set->titles[p],
                   levels == 0   ? "given"
                   : levels == 1 ? "1 level"
                                 : "%zu levels",
                   levels);
    set->panels[p] = (bat_curve_picture_panel){.layers = set->layers[p],
                                               .layer_count = make_layers(job, coarse, truth, fine, levels, set->layers[p]),
                                               .title = job->panel_count > 0 ? set->titles[p] : NULL};
    return EXIT_DONE;
}

int curve_draw(curve_job *job)
{
    panel_set set = {0};
    bat_error error;
    int code = EXIT_DONE;
    size_t count = job->panel_count > 0 ? job->panel_count : 1;
    while (code == EXIT_DONE && set.count < count)
        code = make_panel(job, &set);
    if (code == EXIT_DONE &&
        (bat_curve_picture_projection(set.panels, set.count, &job->draw, &job->findings.projection, &error) != BAT_OK ||
         bat_curve_picture_write(output_path(&job->call.files, "picture"), set.panels, set.count, &job->draw, &error) !=
             BAT_OK))
        code = report_failure(job->call.picture, &error);
    for (size_t p = 0; p < set.count; p++)
    {
        free(set.layers[p]);
        bat_curve_set_free(&set.fine[p]);
    }
    return code;
}
