// Every family of choices: each enumerator of the headers has a row, names are unique, and no required function is missing.

#include "check.h"

#include "batten/batten.h"
#include "curve/scheme_kind.h"
#include "mesh/refine/scheme.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEADERS TEST_DATA "/../../include/batten"

#define ROW(name)                                                                                                           \
    {                                                                                                                       \
#name, &name##_family                                                                                               \
    }

static const struct
{
    const char *name;
    const bat_family *family;
} FAMILIES[] = {
    ROW(bat_space),
    ROW(bat_curve_scheme),
    ROW(bat_curve_scheme_kind),
    ROW(bat_curve_parameters),
    ROW(bat_curve_angle_sign),
    ROW(bat_curve_base),
    ROW(bat_curve_model),
    ROW(bat_curve_end_rule),
    ROW(bat_curve_simple),
    ROW(bat_curve_map_topology),
    ROW(bat_curve_map_edges),
    ROW(bat_curve_map_join),
    ROW(bat_curve_format),
    ROW(bat_curve_projection),
    ROW(bat_motion_scheme),
    ROW(bat_motion_method),
    ROW(bat_motion_ends),
    ROW(bat_motion_shape),
    ROW(bat_time_unit),
    ROW(bat_motion_outliers),
    ROW(bat_mesh_scheme),
    ROW(bat_mesh_boundary),
    ROW(bat_mesh_creasing),
    ROW(bat_mesh_linear),
    ROW(bat_mesh_normals),
    ROW(bat_mesh_format),
    ROW(bat_mesh_encoding),
    ROW(bat_mesh_decimate_method),
    ROW(bat_mesh_up),
    ROW(bat_cloud_format),
    ROW(bat_cloud_sides),
    ROW(bat_cloud_parameterization),
    ROW(bat_surface_parameters),
    ROW(bat_surface_edges),
    ROW(bat_surface_smoothing),
    ROW(bat_surface_format),
    ROW(bat_surface_unit),
    ROW(bat_surface_fault),
    ROW(bat_surface_doubt),
    ROW(bat_surface_primitive_kind),
    ROW(bat_surface_view),
};

enum
{
    FAMILY_COUNT = sizeof FAMILIES / sizeof *FAMILIES
};

/// The public headers, one after the other; release with free().
static char *read_headers(void)
{
    DIR *folder = opendir(HEADERS);
    assert_non_null(folder);
    char *all = NULL;
    size_t size = 0;
    for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder))
    {
        char path[512];
        size_t length = strlen(entry->d_name);
        if (length < 2 || strcmp(entry->d_name + length - 2, ".h") != 0)
            continue;
        (void)snprintf(path, sizeof path, "%s/%s", HEADERS, entry->d_name);
        FILE *file = fopen(path, "r");
        assert_non_null(file);
        all = realloc(all, size + (1 << 20));
        assert_non_null(all);
        size += fread(all + size, 1, (1 << 20) - 1, file);
        all[size] = '\0';
        (void)fclose(file);
    }
    (void)closedir(folder);
    assert_non_null(all);
    return all;
}

/// The enumerators of a type; 0 for none of that name.
static size_t count_enumerators(const char *headers, const char *type)
{
    char head[80];
    (void)snprintf(head, sizeof head, "typedef enum %s\n", type);
    const char *at = strstr(headers, head), *end = at != NULL ? strstr(at, "\n}") : NULL;
    size_t count = 0;
    for (at = at != NULL ? strstr(at, "\n    BAT_") : NULL; at != NULL && at < end; at = strstr(at + 1, "\n    BAT_"))
    {
        size_t length = strcspn(at + 5, " ,\n");
        count += length < 6 || strncmp(at + 5 + length - 6, "_COUNT", 6) != 0;
    }
    return count;
}

static size_t count_rows(const bat_family *family)
{
    size_t rows = family->count;
    bool mesh_formats = family == &bat_mesh_format_family; // 3MF needs zlib
    return mesh_formats && strcmp(bat_choice_name(family, BAT_MESH_FORMAT_3MF), "unknown") == 0 ? rows + 1 : rows;
}

static void every_enumerator_has_a_row(void **state)
{
    (void)state;
    char *headers = read_headers();
    for (size_t f = 0; f < FAMILY_COUNT; f++)
    {
        size_t count = count_enumerators(headers, FAMILIES[f].name);
        if (count == 0)
            continue;
        if (count != count_rows(FAMILIES[f].family))
            fail_msg("%s has %zu enumerators and %zu rows", FAMILIES[f].name, count, FAMILIES[f].family->count);
        for (size_t value = 0; value < FAMILIES[f].family->count; value++)
            assert_string_not_equal(bat_choice_name(FAMILIES[f].family, (int)value), "unknown");
    }
    static const char DECLARATION[] = "\nextern BAT_API const bat_family ";
    size_t declared = 0;
    for (const char *at = headers; (at = strstr(at, DECLARATION)) != NULL;)
        for (at += strlen(DECLARATION); *at != '\n'; at++)
            declared += *at == ',' || *at == ';';
    free(headers);
    assert_int_equal(declared, FAMILY_COUNT);
}

static void names_are_unique(void **state)
{
    (void)state;
    for (size_t f = 0; f < FAMILY_COUNT; f++)
    {
        const bat_family *family = FAMILIES[f].family;
        const bat_choice *row, *found;
        for (size_t i = 0; (row = bat_choices(family, i)) != NULL; i++)
        {
            assert_true(row->name[0] != '\0' && row->summary[0] != '\0');
            assert_true(row->endings == NULL || row->reads || row->writes);
            check_status(bat_choice_find(family, row->name, &found, NULL), BAT_OK);
            assert_ptr_equal(found, row);
        }
        assert_null(bat_choices(family, family->count));
    }
    const bat_choice *row;
    check_status(bat_choice_find(&bat_surface_parameters_family, "given", &row, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_choice_find(&bat_mesh_format_family, "auto", &row, NULL), BAT_OK);
    assert_string_equal(bat_choice_name(&bat_mesh_scheme_family, 17), "unknown");
}

static void no_function_is_missing(void **state)
{
    (void)state;
    const bat_choice *row;
    for (size_t i = 0; (row = choice_at(&bat_curve_scheme_kind_family, i)) != NULL; i++)
    {
        const scheme_kind *kind = (const scheme_kind *)(const void *)row;
        assert_int_equal(kind->kernel != NULL, row->value != BAT_CURVE_SCHEME_KIND_SPLINE);
    }
    for (size_t i = 0; (row = bat_choices(&bat_curve_scheme_family, i)) != NULL; i++)
    {
        const scheme_row *scheme = (const scheme_row *)(const void *)row;
        bool mask = strcmp(row->name, "mask") == 0;
        assert_int_equal(scheme->form != NULL, scheme->kind == BAT_CURVE_SCHEME_KIND_SPLINE);
        bat_curve_scheme made;
        check_status(bat_curve_scheme_by_name(mask ? "mask:1,2,1" : row->name, &made, NULL), BAT_OK);
        assert_true(scheme->kind == BAT_CURVE_SCHEME_KIND_AUTO || made.kind == scheme->kind);
    }
    for (size_t i = 0; (row = bat_choices(&bat_mesh_scheme_family, i)) != NULL; i++)
    {
        const mesh_scheme *scheme = (const mesh_scheme *)(const void *)row;
        assert_int_equal(scheme->rule != NULL, !scheme->turns);
        assert_int_equal(scheme->smooth != NULL, scheme->creases);
    }
    for (size_t i = 0; (row = bat_choices(&bat_space_family, i)) != NULL; i++)
    {
        bat_space space;
        check_status(bat_space_by_name(row->name, 0, &space, NULL), BAT_OK);
    }
    bat_motion_curves_options options = bat_motion_curves_defaults();
    for (size_t i = 0; (row = bat_choices(&bat_motion_scheme_family, i)) != NULL; i++)
        check_status(bat_motion_scheme_by_name(row->name, &options, NULL), BAT_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_enumerator_has_a_row),
        cmocka_unit_test(names_are_unique),
        cmocka_unit_test(no_function_is_missing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
