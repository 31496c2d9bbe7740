#include "research/train/learned_validate.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/curve_measure.h"
#include "batten/research/curve_study.h"
#include "curve/network/learned_rule.h"

#include <stdlib.h>

/// The refined control polygons of one set.
static bat_status refine(const bat_tension_set *set, const bat_space *space, const bat_curve_angle_rule *rule,
                         double fairness, int threads, bat_curve *coarse, bat_curve *fine, bat_error *error)
{
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.scheme = bat_curve_scheme_angle_rule(rule);
    options.scheme.fairness = fairness;
    options.levels = BAT_TENSION_LEVELS;
    options.threads = threads;
    for (size_t i = 0; i < set->count; i++)
        coarse[i] = bat_tension_control(set, i, space);
    return bat_curves_refine(coarse, set->count, &options, fine, NULL, error);
}

static bat_status measure(const bat_tension_set *set, const bat_space *space, const bat_curve *fine,
                          bat_learned_score *score, bat_error *error)
{
    bat_status status = BAT_OK;
    bat_learned_score sum = {0};
    for (size_t i = 0; i < set->count && status == BAT_OK; i++)
    {
        bat_curve truth = bat_tension_truth(set, i, space);
        bat_curve_distance distance;
        bat_curve_fairness_values fairness;
        status = bat_curve_compare(&fine[i], &truth, NULL, &distance, error);
        if (status == BAT_OK)
            status = bat_curve_fairness(&fine[i], NULL, &fairness, error);
        if (status != BAT_OK)
            break;
        sum.mean_nn += distance.mean_nn;
        sum.bending += fairness.bending;
        sum.g1 += fairness.g1;
    }
    double n = (double)set->count;
    *score = (bat_learned_score){sum.mean_nn / n, sum.bending / n, sum.g1 / n};
    return status;
}

bat_status learned_validate(const learn_parameters *parameters, const bat_tension_set sets[BAT_TENSION_SPACE_COUNT],
                            double fairness, int threads, bat_learned_score scores[BAT_TENSION_SPACE_COUNT],
                            bat_error *error)
{
    const bat_space spaces[BAT_TENSION_SPACE_COUNT] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    bat_status status = BAT_OK;
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT && status == BAT_OK; s++)
    {
        size_t count = sets[s].count;
        const bat_curve_angle_rule rule = learned_rule(parameters->values);
        bat_curve *curves = calloc(2 * count, sizeof *curves);
        if (curves == NULL)
            return error_memory(error, 2 * count * sizeof *curves);
        status = refine(&sets[s], &spaces[s], &rule, fairness, threads, curves, curves + count, error);
        if (status == BAT_OK)
            status = measure(&sets[s], &spaces[s], curves + count, &scores[s], error);
        for (size_t i = 0; i < count; i++)
            bat_curve_free(&curves[count + i]);
        free(curves);
    }
    return status;
}
