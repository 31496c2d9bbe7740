#include "research/studies/harm.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "base/progress.h"
#include "base/threads.h"
#include "batten/research/harm_study.h"

#include <math.h>
#include <stdlib.h>

/// @file
/// The table of a search for harm.

static const size_t MAX_COUNT = 100000;

bat_harm_study_options bat_harm_study_defaults(void)
{
    return (bat_harm_study_options){.count = 20, .seed = 1};
}

static const harm_kind *kind_at(size_t index)
{
    if (index < HARM_LINE_COUNT)
        return &HARM_LINES[index];
    index -= HARM_LINE_COUNT;
    return index < HARM_SURFACE_COUNT ? &HARM_SURFACES[index] : &HARM_MAPS[index - HARM_SURFACE_COUNT];
}

/// What a case gave.
typedef struct harm_result
{
    bat_status status;
    double ratio;
} harm_result;

/// Run a case. Its input depends on the seed, the kind and its number alone.
static harm_result run_case(uint64_t seed, size_t kind, size_t number)
{
    static const uint64_t KIND = 0x9E3779B97F4A7C15, NUMBER = 0xC2B2AE3D27D4EB4F; // odd, so that products differ
    bat_random random = bat_random_seed(seed + KIND * (kind + 1) + NUMBER * (number + 1));
    harm_result result = {.ratio = NAN};
    bat_error error;
    result.status = kind_at(kind)->run(&random, kind_at(kind)->variant, &result.ratio, &error);
    return result;
}

/// Sum up the cases of a kind. `ratios` is room for them.
static bat_harm_row row_of(const harm_kind *kind, const harm_result *results, size_t count, double *ratios)
{
    bat_harm_row row = {
        .system = kind->system, .kind = kind->name, .rival = kind->rival, .tried = count, .median = NAN, .worst = NAN};
    size_t made = 0;
    for (size_t i = 0; i < count; i++)
    {
        if (results[i].status != BAT_OK)
        {
            row.refused++;
            continue;
        }
        row.harmed += results[i].ratio > BAT_HARM_RATIO;
        if (made == 0 || results[i].ratio > row.worst)
        {
            row.worst = results[i].ratio;
            row.worst_case = i;
        }
        ratios[made++] = results[i].ratio;
    }
    qsort(ratios, made, sizeof *ratios, ascending);
    if (made > 0)
        row.median = (ratios[(made - 1) / 2] + ratios[made / 2]) / 2;
    return row;
}

bat_status bat_harm_study(const bat_harm_study_options *options, bat_harm_row **rows, size_t *row_count, bat_error *error)
{
    bat_harm_study_options how = options != NULL ? *options : bat_harm_study_defaults();
    size_t kinds = HARM_LINE_COUNT + HARM_SURFACE_COUNT + HARM_MAP_COUNT;
    if (how.count < 1 || how.count > MAX_COUNT)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "count is %zu, but must be from 1 to %zu", how.count,
                         MAX_COUNT);
    harm_result *results = memory_array(kinds * how.count, sizeof *results);
    double *ratios = memory_array(how.count, sizeof *ratios);
    bat_harm_row *made = memory_array(kinds, sizeof *made);
    bat_status status = BAT_OK;
    if (results == NULL || ratios == NULL || made == NULL)
        status = error_memory(error, kinds * how.count * sizeof *results);
    for (size_t kind = 0; kind < kinds && status == BAT_OK; kind++)
    {
        harm_result *of_kind = results + kind * how.count;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads_for(how.threads, how.count))
        for (size_t i = 0; i < how.count; i++)
            of_kind[i] = run_case(how.seed, kind, i);
        for (size_t i = 0; i < how.count; i++)
            if (of_kind[i].status == BAT_NO_MEMORY)
                status = error_memory(error, 0);
        made[kind] = row_of(kind_at(kind), of_kind, how.count, ratios);
        double share = (double)(kind + 1) / (double)kinds;
        if (status == BAT_OK && how.progress.report != NULL && !how.progress.report(how.progress.context, share))
            status = error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped");
    }
    free(results);
    free(ratios);
    if (status == BAT_OK)
    {
        *rows = made;
        *row_count = kinds;
    }
    else
        free(made);
    return status;
}
