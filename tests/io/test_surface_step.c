// Spline surfaces as STEP: the text is parsed, its faces evaluate to the surface, and its edges join them.

#include "surface/spline/tensor_surface.h"
#include "surface_helpers.h"
#include "tensor_helpers.h"

#include "io/surface/step.h"

/// An entity: its keyword and the text between its parentheses.
typedef struct entity
{
    const char *keyword, *body;
} entity;

/// The entities of a file by number, from 1.
typedef struct step_file
{
    char *text;
    entity *entities;
    size_t count;
} step_file;

/// Divide the text into entities, in place.
static step_file parse_file(char *text)
{
    step_file file = {.text = text};
    static const char head[] = "ISO-10303-21;\nHEADER;\n", tail[] = "ENDSEC;\nEND-ISO-10303-21;\n";
    assert_memory_equal(text, head, sizeof head - 1);
    assert_string_equal(text + strlen(text) - strlen(tail), tail);
    char *at = strstr(text, "\nDATA;\n") + strlen("\nDATA;\n");
    char *end = text + strlen(text) - strlen(tail);
    file.entities = calloc((size_t)(end - at) + 1, sizeof *file.entities);
    while (at < end)
    {
        size_t number = 0;
        int length = 0;
        assert_int_equal(sscanf(at, "#%zu=%n", &number, &length), 1);
        assert_int_equal(number, file.count + 1);
        char *last = strstr(at, ";\n"), *open = strchr(at, '(');
        assert_non_null(last);
        *last = '\0';
        *open = '\0';
        file.entities[++file.count] = (entity){at + length, open + 1};
        at = last + 2;
    }
    return file;
}

static void free_file(step_file *file)
{
    free(file->text);
    free(file->entities);
}

static const entity *must_be(const step_file *file, size_t number, const char *keyword)
{
    assert_in_range(number, 1, file->count);
    assert_string_equal(file->entities[number].keyword, keyword);
    return &file->entities[number];
}

/// The position after the parameter that begins here and its comma.
static const char *next_parameter(const char *at)
{
    int depth = 0;
    for (; *at != '\0' && (depth > 0 || *at != ','); at++)
        depth += (*at == '(') - (*at == ')');
    return at + (*at == ',');
}

static const char *parameter(const entity *of, int index)
{
    const char *at = of->body;
    while (index-- > 0)
        at = next_parameter(at);
    return at;
}

static size_t reference(const char *at)
{
    assert_int_equal(*at, '#');
    return (size_t)strtoul(at + 1, NULL, 10);
}

static const char *skip_marks(const char *at)
{
    while (*at == '(' || *at == ',' || *at == '\n' || *at == '#')
        at++;
    return at;
}

/// The numbers of a list of any depth; real ones have a decimal point.
static size_t read_list(const char *at, bool real, double *numbers)
{
    const char *end = next_parameter(at);
    size_t count = 0;
    for (at = skip_marks(at); at < end && *at != ')'; at = skip_marks(at))
    {
        char *after;
        numbers[count++] = strtod(at, &after);
        assert_int_equal(memchr(at, '.', (size_t)(after - at)) != NULL, real);
        assert_null(memchr(at, 'e', (size_t)(after - at)));
        for (at = after; at[0] == ')' && at[1] == ',';)
            at++;
    }
    return count;
}

enum
{
    MAX_NUMBERS = 10000
};

static void read_point(const step_file *file, size_t number, double point[3])
{
    assert_int_equal(read_list(parameter(must_be(file, number, "CARTESIAN_POINT"), 1), true, point), 3);
}

/// The points of a list of references.
static size_t read_points(const step_file *file, const char *list, double *points)
{
    double numbers[MAX_NUMBERS];
    size_t count = read_list(list, false, numbers);
    for (size_t i = 0; i < count; i++)
        read_point(file, (size_t)numbers[i], points + 3 * i);
    return count;
}

/// Knots from their multiplicities and values.
static bat_knot_vector read_knots(int degree, const char *multiplicities, const char *places)
{
    double counts[MAX_NUMBERS], place[MAX_NUMBERS];
    size_t count = read_list(multiplicities, false, counts);
    assert_int_equal(read_list(places, true, place), count);
    bat_knot_vector knots = {.knots = malloc(MAX_NUMBERS * sizeof(double)), .degree = degree};
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < (int)counts[i]; k++)
            knots.knots[knots.count++] = place[i];
    return knots;
}

static tensor_surface read_surface(const step_file *file, size_t number)
{
    const entity *of = must_be(file, number, "B_SPLINE_SURFACE_WITH_KNOTS");
    tensor_surface surface = {.dimension = 3};
    surface.knots[0] = read_knots(atoi(parameter(of, 1)), parameter(of, 8), parameter(of, 10));
    surface.knots[1] = read_knots(atoi(parameter(of, 2)), parameter(of, 9), parameter(of, 11));
    size_t columns = knot_vector_functions(&surface.knots[0]), rows = knot_vector_functions(&surface.knots[1]);
    double *points = malloc(3 * MAX_NUMBERS * sizeof *points);
    assert_int_equal(read_points(file, parameter(of, 3), points), columns * rows);
    surface.control = malloc(3 * columns * rows * sizeof *surface.control);
    for (size_t i = 0; i < columns; i++)
        for (size_t j = 0; j < rows; j++)
            memcpy(surface.control + 3 * (j * columns + i), points + 3 * (i * rows + j), 3 * sizeof *points);
    free(points);
    check_tensor_surface(&surface);
    return surface;
}

/// A curve as a surface that is constant in v.
static tensor_surface read_curve(const step_file *file, size_t number)
{
    const entity *of = must_be(file, number, "B_SPLINE_CURVE_WITH_KNOTS");
    tensor_surface curve = {.dimension = 3, .control = malloc(3 * MAX_NUMBERS * sizeof *curve.control)};
    curve.knots[0] = read_knots(atoi(parameter(of, 1)), parameter(of, 6), parameter(of, 7));
    curve.knots[1] = (bat_knot_vector){.knots = calloc(2, sizeof(double)), .count = 2};
    curve.knots[1].knots[1] = 1;
    assert_int_equal(read_points(file, parameter(of, 2), curve.control), knot_vector_functions(&curve.knots[0]));
    check_tensor_surface(&curve);
    return curve;
}

static void domain(const bat_knot_vector *knots, double range[2])
{
    range[0] = knots->knots[knots->degree];
    range[1] = knots->knots[knot_vector_functions(knots)];
    // Clamped at both ends.
    assert_true(knots->knots[0] == range[0] && knots->knots[knots->count - 1] == range[1]);
}

/// Compare a face's patch with the surface; returns the patch's area in the square.
static double check_patch(const bat_spline_surface *surface, const tensor_surface *patch)
{
    double u[2], v[2];
    domain(&patch->knots[0], u);
    domain(&patch->knots[1], v);
    for (int i = 0; i <= 6; i++)
        for (int j = 0; j <= 6; j++)
        {
            const double at[2] = {i == 6 ? u[1] : u[0] + (u[1] - u[0]) * i / 6,
                                  j == 6 ? v[1] : v[0] + (v[1] - v[0]) * j / 6};
            double found[3], expected[3];
            tensor_surface_at(patch, at, found);
            evaluate_at(surface, at[0], at[1], expected);
            for (int c = 0; c < 3; c++)
                check_near(found[c], expected[c], 1e-14);
        }
    return (u[1] - u[0]) * (v[1] - v[0]);
}

/// The uses of an edge in both directions, and its curve in the square.
typedef struct edge_uses
{
    int forward, backward;
} edge_uses;

/// The parameters at the ends of an edge, in its direction, on a side of a patch.
static void edge_ends(const tensor_surface *curve, const double point[3], bool begin)
{
    double range[2], at[2] = {0, 0.5}, found[3];
    domain(&curve->knots[0], range);
    at[0] = range[begin ? 0 : 1];
    tensor_surface_at(curve, at, found);
    assert_memory_equal(found, point, sizeof found);
}

static void read_vertex(const step_file *file, size_t number, double point[3])
{
    read_point(file, reference(parameter(must_be(file, number, "VERTEX_POINT"), 1)), point);
}

/// The curve of an edge lies on a side of a patch. In a sheet (u, v, height) the first coordinates are the parameters.
static void check_edge_on_patch(const tensor_surface *curve, const tensor_surface *patch)
{
    double range[2], u[2], v[2];
    domain(&curve->knots[0], range);
    domain(&patch->knots[0], u);
    domain(&patch->knots[1], v);
    for (int i = 0; i <= 5; i++)
    {
        const double at[2] = {range[0] + (range[1] - range[0]) * i / 5, 0.5};
        double point[3], found[3];
        tensor_surface_at(curve, at, point);
        const double on[2] = {fmin(fmax(point[0], u[0]), u[1]), fmin(fmax(point[1], v[0]), v[1])};
        tensor_surface_at(patch, on, found);
        for (int c = 0; c < 3; c++)
            check_near(found[c], point[c], 1e-13);
        double to_side = fmin(fmin(on[0] - u[0], u[1] - on[0]), fmin(on[1] - v[0], v[1] - on[1]));
        check_near(to_side, 0, 1e-13);
    }
}

/// The edges of a loop are consecutive, with the face on their left.
static void check_loop(const step_file *file, size_t loop, const tensor_surface *patch, edge_uses *uses)
{
    double oriented[MAX_NUMBERS], turn = 0;
    size_t count = read_list(parameter(must_be(file, loop, "EDGE_LOOP"), 1), false, oriented);
    size_t first = 0, before = 0;
    for (size_t i = 0; i < count; i++)
    {
        const entity *use = must_be(file, (size_t)oriented[i], "ORIENTED_EDGE");
        size_t edge = reference(parameter(use, 3));
        bool forward = strncmp(parameter(use, 4), ".T.", 3) == 0;
        const entity *of = must_be(file, edge, "EDGE_CURVE");
        size_t from = reference(parameter(of, forward ? 1 : 2)), to = reference(parameter(of, forward ? 2 : 1));
        uses[edge].forward += forward;
        uses[edge].backward += !forward;
        if (i == 0)
            first = from;
        else
            assert_int_equal(from, before);
        before = to;
        double a[3], b[3];
        read_vertex(file, from, a);
        read_vertex(file, to, b);
        turn += a[0] * b[1] - a[1] * b[0];
        tensor_surface curve = read_curve(file, reference(parameter(of, 3)));
        edge_ends(&curve, forward ? a : b, true);
        edge_ends(&curve, forward ? b : a, false);
        check_edge_on_patch(&curve, patch);
        tensor_surface_free(&curve);
    }
    assert_int_equal(before, first);
    assert_true(turn > 0);
}

static size_t count_keyword(const step_file *file, const char *keyword)
{
    size_t count = 0;
    for (size_t i = 1; i <= file->count; i++)
        count += strcmp(file->entities[i].keyword, keyword) == 0;
    return count;
}

/// Every face is in the shell; every edge is used twice, or once on the border of the square.
static void check_shell(const step_file *file, const bat_spline_surface *surface)
{
    double faces[MAX_NUMBERS], area = 0, border = 0;
    size_t shell = 1;
    while (strcmp(file->entities[shell].keyword, "OPEN_SHELL") != 0)
        shell++;
    size_t count = read_list(parameter(&file->entities[shell], 1), false, faces);
    edge_uses *uses = calloc(file->count + 1, sizeof *uses);
    for (size_t i = 0; i < count; i++)
    {
        const entity *face = must_be(file, (size_t)faces[i], "ADVANCED_FACE");
        tensor_surface patch = read_surface(file, reference(parameter(face, 2)));
        area += check_patch(surface, &patch);
        size_t bound = (size_t)strtoul(parameter(face, 1) + 2, NULL, 10);
        check_loop(file, reference(parameter(must_be(file, bound, "FACE_OUTER_BOUND"), 1)), &patch, uses);
        tensor_surface_free(&patch);
    }
    check_near(area, 1, 1e-14);
    assert_int_equal(count_keyword(file, "ADVANCED_FACE"), count);
    size_t edges = count_keyword(file, "EDGE_CURVE"), vertices = count_keyword(file, "VERTEX_POINT");
    assert_int_equal(vertices + count, edges + 1);
    for (size_t e = 1; e <= file->count; e++)
    {
        if (strcmp(file->entities[e].keyword, "EDGE_CURVE") != 0)
            continue;
        assert_in_range(uses[e].forward + uses[e].backward, 1, 2);
        if (uses[e].forward + uses[e].backward == 2)
        {
            assert_int_equal(uses[e].forward, 1);
            continue;
        }
        double a[3], b[3];
        read_vertex(file, reference(parameter(&file->entities[e], 1)), a);
        read_vertex(file, reference(parameter(&file->entities[e], 2)), b);
        border += hypot(b[0] - a[0], b[1] - a[1]);
    }
    check_near(border, 4, 1e-13);
    free(uses);
}

static void test_sheets(void **state)
{
    (void)state;
    static const surface_kind kinds[] = {
        {{2, 2}, {1, 1}, true, 0, 3, 5}, {{3, 1}, {2, 3}, true, 0, 3, 6}, {{2, 3}, {3, 2}, true, 2, 3, 4},
        {{2, 2}, {3, 3}, true, 0, 3, 0}, {{5, 2}, {4, 4}, true, 0, 3, 9},
    };
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        for (uint64_t seed = 0; seed < 6; seed++)
        {
            bat_spline_surface surface = random_sheet(&kinds[k], seed);
            step_file file = parse_file(must_write(&surface, BAT_SURFACE_FORMAT_STEP, NULL));
            check_shell(&file, &surface);
            free_file(&file);
            bat_spline_surface_free(&surface);
        }
}

/// A collapsed side is not an edge, and its ends are one vertex.
static void test_cone(void **state)
{
    (void)state;
    bat_spline_surface surface = random_sheet(&(surface_kind){{2, 2}, {1, 1}, true, 0, 3, 0}, 5);
    for (size_t f = 0; f < 9; f++)
    {
        double angle = (double)(f % 3), radius = (double)(f / 3);
        const double point[3] = {radius * cos(angle), radius * sin(angle), 5 - radius};
        memcpy(surface.control + 3 * f, point, sizeof point);
    }
    step_file file = parse_file(must_write(&surface, BAT_SURFACE_FORMAT_STEP, NULL));
    assert_int_equal(count_keyword(&file, "VERTEX_POINT"), 3);
    assert_int_equal(count_keyword(&file, "EDGE_CURVE"), 3);
    assert_int_equal(count_keyword(&file, "ORIENTED_EDGE"), 3);
    free_file(&file);
    bat_spline_surface_free(&surface);
}

/// The entities by which a reader finds the shape, its unit and its product.
static void test_product(void **state)
{
    (void)state;
    bat_spline_surface surface = random_sheet(&(surface_kind){{2, 2}, {1, 1}, true, 0, 3, 0}, 1);
    char *text = must_write(&surface, BAT_SURFACE_FORMAT_STEP, NULL);
    assert_non_null(strstr(text, "FILE_SCHEMA(('AP242"));
    assert_non_null(strstr(text, "SI_UNIT(.MILLI.,.METRE.)"));
    step_file file = parse_file(text);
    size_t link = 1;
    while (strcmp(file.entities[link].keyword, "SHAPE_DEFINITION_REPRESENTATION") != 0)
        link++;
    const entity *shape = must_be(&file, reference(file.entities[link].body), "PRODUCT_DEFINITION_SHAPE");
    const entity *definition = must_be(&file, reference(parameter(shape, 2)), "PRODUCT_DEFINITION");
    const entity *formation = must_be(&file, reference(parameter(definition, 2)), "PRODUCT_DEFINITION_FORMATION");
    (void)must_be(&file, reference(parameter(formation, 2)), "PRODUCT");
    const entity *model =
        must_be(&file, reference(parameter(&file.entities[link], 1)), "MANIFOLD_SURFACE_SHAPE_REPRESENTATION");
    assert_non_null(strstr(model->body, "#"));
    free_file(&file);
    bat_spline_surface_free(&surface);
}

/// The real numbers of ISO 10303-21.
static void test_reals(void **state)
{
    (void)state;
    static const struct
    {
        double value;
        const char *text;
    } reals[] = {{0, "0."},         {-3, "-3."},           {0.5, "0.5"},
                 {1e-20, "1.E-20"}, {1.5e300, "1.5E+300"}, {1. / 3, "0.3333333333333333"}};
    for (size_t i = 0; i < sizeof reals / sizeof *reals; i++)
    {
        char text[64];
        *model_real(text, reals[i].value, 'E') = '\0';
        assert_string_equal(text, reals[i].text);
    }
}

/// Two long rectangles on three short ones: every side is divided at all corners on it.
static void test_bricks(void **state)
{
    (void)state;
    static const shell_face bricks[] = {
        {{0, 0}, {3, 2}}, {{3, 0}, {6, 2}}, {{0, 2}, {2, 4}}, {{2, 2}, {4, 4}}, {{4, 2}, {6, 4}}};
    surface_shell shell;
    check_status(shell_make(bricks, 5, &shell, NULL), BAT_OK);
    assert_int_equal(shell.vertex_count, 3 + 5 + 4);
    assert_int_equal(shell.edge_count, 2 + 3 + 4 + 3 + 4);
    assert_int_equal(shell.loops[1] - shell.loops[0], 5);
    static const uint64_t path[][2] = {{0, 0}, {3, 0}, {3, 2}, {2, 2}, {0, 2}};
    for (size_t i = 0; i < 5; i++)
    {
        const shell_use *use = &shell.uses[i];
        const shell_edge *edge = &shell.edges[use->edge];
        const uint64_t *from = shell.vertices + 2 * (use->backward ? edge->to : edge->from);
        assert_memory_equal(from, path[i], sizeof path[i]);
    }
    size_t border = 0;
    for (size_t e = 0; e < shell.edge_count; e++)
        border += shell.edges[e].faces[1] == SHELL_NONE;
    assert_int_equal(border, 2 + 2 + 3 + 2);
    shell_free(&shell);
}

/// A part of a curve is that curve; the whole keeps its bits.
static void test_cut(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(4);
    for (int degree = 1; degree <= 5; degree++)
    {
        bat_knot_vector knots, cut, again;
        check_status(knot_vector_uniform(degree, 6, &knots, NULL), BAT_OK);
        size_t count = knot_vector_functions(&knots);
        double control[2 * 20], part[2 * 20], whole[2 * 20];
        for (size_t i = 0; i < 2 * count; i++)
            control[i] = bat_random_normal(&random);
        const tensor_surface curve = {{knots, {(double[]){0, 1}, 2, 0}}, control, 2};
        check_status(knot_vector_cut(&knots, 0, 1, &again, NULL), BAT_OK);
        tensor_surface_convert(&curve, 0, &again, whole);
        assert_memory_equal(whole, control, 2 * count * sizeof *control);
        check_status(knot_vector_cut(&knots, 0.2, 5. / 6, &cut, NULL), BAT_OK);
        tensor_surface_convert(&curve, 0, &cut, part);
        for (int i = 0; i <= 30; i++)
        {
            double t = i == 30 ? 5. / 6 : 0.2 + (5. / 6 - 0.2) * i / 30, basis[6];
            double sums[4] = {0};
            size_t span = knot_vector_span(&knots, t);
            knot_vector_basis(&knots, span, t, 0, basis);
            for (size_t k = 0; k <= (size_t)degree; k++)
                for (size_t c = 0; c < 2; c++)
                    sums[c] += basis[k] * control[2 * (span - (size_t)degree + k) + c];
            span = knot_vector_span(&cut, t);
            knot_vector_basis(&cut, span, t, 0, basis);
            for (size_t k = 0; k <= (size_t)degree; k++)
                for (size_t c = 0; c < 2; c++)
                    sums[2 + c] += basis[k] * part[2 * (span - (size_t)degree + k) + c];
            check_near(sums[2], sums[0], 1e-14);
            check_near(sums[3], sums[1], 1e-14);
        }
        knot_vector_free(&knots);
        knot_vector_free(&cut);
        knot_vector_free(&again);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sheets), cmocka_unit_test(test_cone),   cmocka_unit_test(test_product),
        cmocka_unit_test(test_reals),  cmocka_unit_test(test_bricks), cmocka_unit_test(test_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
