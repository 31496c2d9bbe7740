#include "paint.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// Ways in which an image goes on beyond its borders, as glTF numbers them; by others it is repeated.
enum
{
    WRAP_CLAMP = 33071,
    WRAP_MIRROR = 33648
};

/// The colour of a material.
typedef struct paint
{
    size_t image;               ///< SIZE_MAX for none
    double factor[3];           ///< in linear light
    double scale[2], offset[2]; ///< of texture coordinates, which count from the top
    int wrap[2];
    bool vertices; ///< the colours of the vertices are factors, too
} paint;

typedef struct paint_image
{
    char *name;
    bat_mesh_image pixels;
} paint_image;

struct mesh_paints
{
    const bat_mesh *mesh;
    const char *path;
    size_t count;
    paint *paints;       ///< one for each label, at least one
    paint_image *images; ///< image_count
    size_t image_count;
    size_t places[3];            ///< of the colours among the channels
    bool colours;                ///< the vertices have some
    bool linear;                 ///< these are in linear light
    double light[UINT8_MAX + 1]; ///< the linear light of a byte
};

void mesh_paints_free(mesh_paints *paints)
{
    for (size_t i = 0; paints != NULL && i < paints->image_count; i++)
    {
        free(paints->images[i].name);
        free(paints->images[i].pixels.pixels);
    }
    if (paints != NULL)
    {
        free(paints->images);
        free(paints->paints);
    }
    free(paints);
}

static bat_status fail(bat_error *error, bat_status status, const char *format, ...) __attribute__((format(printf, 3, 4)));

static bat_status fail(bat_error *error, bat_status status, const char *format, ...)
{
    va_list arguments;
    *error = (bat_error){.status = status, .operand = BAT_NO_INDEX, .curve = BAT_NO_INDEX, .index = BAT_NO_INDEX};
    va_start(arguments, format);
    (void)vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    return status;
}

static bat_status no_memory(bat_error *error)
{
    return fail(error, BAT_NO_MEMORY, "out of memory");
}

// Colours

/// From sRGB to linear light.
static double decode(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

/// Back, in bytes.
static unsigned char encode(double linear)
{
    double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
    return (unsigned char)(fmin(1, fmax(0, encoded)) * UINT8_MAX + 0.5);
}

/// The pixel at a whole number, which may lie beyond the borders.
static size_t wrapped(double at, size_t size, int how)
{
    double whole = (double)size, turns = floor(at / whole), within = how == WRAP_CLAMP ? at : at - turns * whole;
    if (how == WRAP_MIRROR && fmod(turns, 2) != 0)
        within = whole - 1 - within;
    return (size_t)fmin(whole - 1, fmax(0, within));
}

/// Multiply a colour by that of an image, bilinearly between the centres of its pixels.
static void multiply(const mesh_paints *paints, const paint *of, const double place[2], double colour[3])
{
    const bat_mesh_image *image = &paints->images[of->image].pixels;
    const size_t sizes[2] = {image->width, image->height};
    size_t pixels[2][2];
    double shares[2][2];
    for (size_t k = 0; k < 2; k++)
    {
        double at = (place[k] * of->scale[k] + of->offset[k]) * (double)sizes[k] - 0.5, below = floor(at);
        shares[k][1] = at - below;
        shares[k][0] = 1 - shares[k][1];
        for (size_t i = 0; i < 2; i++)
            pixels[k][i] = wrapped(below + (double)i, sizes[k], of->wrap[k]);
    }
    for (size_t k = 0; k < 3; k++)
    {
        double sum = 0;
        for (size_t y = 0; y < 2; y++)
            for (size_t x = 0; x < 2; x++)
                sum += shares[0][x] * shares[1][y] *
                       paints->light[image->pixels[3 * (pixels[1][y] * image->width + pixels[0][x]) + k]];
        colour[k] *= sum;
    }
}

void mesh_paints_at(const void *paints, const bat_mesh_point *point, unsigned char colour[3])
{
    const mesh_paints *all = paints;
    const bat_mesh *mesh = all->mesh;
    const paint *of = &all->paints[mesh->face_labels != NULL ? mesh->face_labels[point->face] : 0];
    double light[3], place[2] = {0, 1}, own[3] = {0};
    memcpy(light, of->factor, sizeof light);
    for (size_t c = 0; c < 3; c++)
    {
        size_t corner = 3 * (size_t)point->face + c;
        double weight = point->barycentric[c];
        for (size_t k = 0; k < 3 && of->vertices; k++)
            own[k] += weight * mesh->channels[mesh->faces[corner] * mesh->channel_count + all->places[k]];
        if (of->image == SIZE_MAX)
            continue;
        const double *at = mesh->texture + 2 * (size_t)mesh->texture_faces[corner];
        place[0] += weight * at[0];
        place[1] -= weight * at[1];
    }
    if (of->image != SIZE_MAX)
        multiply(all, of, place, light);
    for (size_t k = 0; k < 3; k++)
        colour[k] = encode(light[k] * (of->vertices ? all->linear ? own[k] : decode(own[k]) : 1));
}

/// Find the image of a URI, or read it.
static bat_status find_image(mesh_paints *paints, const char *uri, size_t *number, bat_error *error)
{
    for (*number = 0; *number < paints->image_count; ++*number)
        if (strcmp(paints->images[*number].name, uri) == 0)
            return BAT_OK;
    paint_image made = {.name = strdup(uri)};
    if (made.name == NULL)
        return no_memory(error);
    bat_error own = {0};
    bat_status status = bat_mesh_image_read(uri, paints->path, &made.pixels, &own);
    if (status == BAT_OK)
    {
        paint_image *images = realloc(paints->images, (paints->image_count + 1) * sizeof *images);
        if (images == NULL)
        {
            free(made.pixels.pixels);
            free(made.name);
            return no_memory(error);
        }
        paints->images = images;
        images[paints->image_count++] = made;
    }
    else
    {
        (void)fail(error, status, "%.220s; without color --bake does not need it", own.text);
        free(made.name);
    }
    return status;
}

/// Halve an image by means of its pixels, in linear light. False when out of memory.
static bool halve(const mesh_paints *paints, bat_mesh_image *image)
{
    bat_mesh_image half = {.width = (image->width + 1) / 2, .height = (image->height + 1) / 2};
    half.pixels = malloc(3 * half.width * half.height);
    for (size_t i = 0; i < 3 * half.width * half.height && half.pixels != NULL; i++)
    {
        size_t x = 2 * (i / 3 % half.width), y = 2 * (i / 3 / half.width);
        double sum = 0;
        for (size_t k = 0; k < 4; k++)
        {
            size_t u = x + k % 2 < image->width ? x + k % 2 : x, v = y + k / 2 < image->height ? y + k / 2 : y;
            sum += paints->light[image->pixels[3 * (v * image->width + u) + i % 3]];
        }
        half.pixels[i] = encode(sum / 4);
    }
    if (half.pixels == NULL)
        return false;
    free(image->pixels);
    *image = half;
    return true;
}

/// Halve images of which more pixels are used than baked ones hold, so that no detail between texels is lost. False when
/// out of memory.
static bool halve_large(mesh_paints *paints, size_t size)
{
    const bat_mesh *mesh = paints->mesh;
    double *used = calloc(paints->image_count + 1, sizeof *used), room = (double)size * (double)size;
    for (size_t f = 0; f < mesh->face_count && mesh->texture_faces != NULL && used != NULL; f++)
    {
        const paint *of = &paints->paints[mesh->face_labels != NULL ? mesh->face_labels[f] : 0];
        if (of->image == SIZE_MAX)
            continue;
        const double *at[3];
        for (size_t c = 0; c < 3; c++)
            at[c] = mesh->texture + 2 * (size_t)mesh->texture_faces[3 * f + c];
        used[of->image] +=
            fabs(((at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[2][0] - at[0][0]) * (at[1][1] - at[0][1])) *
                 of->scale[0] * of->scale[1]) /
            2;
    }
    bool good = used != NULL;
    for (size_t i = 0; i < paints->image_count && good; i++)
    {
        bat_mesh_image *image = &paints->images[i].pixels;
        while (good && image->width > 1 && used[i] * (double)image->width * (double)image->height >= 4 * room)
            good = halve(paints, image);
    }
    free(used);
    return good;
}

// glTF

/// Read the texture of a base colour.
static bat_status read_texture(mesh_paints *paints, const json_t *root, json_t *info, paint *made, bat_error *error)
{
    int index = 0, second = 0, source = -1, webp = -1, sampler = -1;
    double turn = 0;
    const char *uri;
    bool good = json_unpack(info, "{s:i, s?i, s?{s?{s?[FF], s?[FF], s?F, s?i}}}", "index", &index, "texCoord", &second,
                            "extensions", "KHR_texture_transform", "scale", &made->scale[0], &made->scale[1], "offset",
                            &made->offset[0], &made->offset[1], "rotation", &turn, "texCoord", &second) == 0;
    json_t *texture = json_array_get(json_object_get(root, "textures"), (size_t)index);
    good = good && json_unpack(texture, "{s?i, s?i, s?{s?{s?i}}}", "source", &source, "sampler", &sampler, "extensions",
                               "EXT_texture_webp", "source", &webp) == 0;
    json_t *image = json_array_get(json_object_get(root, "images"), (size_t)(source >= 0 ? source : webp)),
           *found = json_array_get(json_object_get(root, "samplers"), (size_t)sampler);
    good = good && json_unpack(image, "{s:s}", "uri", &uri) == 0 &&
           (found == NULL || json_unpack(found, "{s?i, s?i}", "wrapS", &made->wrap[0], "wrapT", &made->wrap[1]) == 0);
    if (!good)
        return fail(error, BAT_BAD_FILE, "texture %d of a base colour, its sampler or its image is invalid", index);
    if (turn != 0 || second != 0)
        return fail(error, BAT_UNSUPPORTED, "colours are not baked by rotated or second texture coordinates");
    return find_image(paints, uri, &made->image, error);
}

/// Read the paint of the material with a name.
static bat_status read_material(mesh_paints *paints, const json_t *root, const char *name, paint *made, bat_error *error)
{
    json_t *material, *info = NULL;
    size_t i;
    bool good = true;
    json_array_foreach(json_object_get(root, "materials"), i, material)
    {
        const char *other = json_string_value(json_object_get(material, "name"));
        if (name != NULL && other != NULL && strcmp(name, other) == 0)
            good = json_unpack(material, "{s?{s?[FFF*], s?o}}", "pbrMetallicRoughness", "baseColorFactor", &made->factor[0],
                               &made->factor[1], &made->factor[2], "baseColorTexture", &info) == 0;
    }
    if (!good)
        return fail(error, BAT_BAD_FILE, "the base colour of material '%.60s' is invalid", name);
    return info != NULL && paints->mesh->texture_faces != NULL ? read_texture(paints, root, info, made, error) : BAT_OK;
}

// MTL

/// Whether a line begins with a word; then it is moved to the next one.
static bool take_word(char **line, const char *word)
{
    static const char blanks[] = " \t";
    size_t size = strlen(word);
    if (strncmp(*line, word, size) != 0 || ((*line)[size] != '\0' && strchr(blanks, (*line)[size]) == NULL))
        return false;
    *line += size;
    *line += strspn(*line, blanks);
    return true;
}

static bool take_number(char **line, double *value)
{
    char *end;
    double number = strtod(*line, &end);
    if (end == *line || !isfinite(number) || (*end != '\0' && strchr(" \t", *end) == NULL)) // as in 1.png
        return false;
    *value = number;
    *line = end + strspn(end, " \t");
    return true;
}

/// Read the options of a map up to the name of its image.
static void read_map_options(char **line, paint *made)
{
    while (**line == '-')
    {
        bool scale = take_word(line, "-s"), offset = !scale && take_word(line, "-o"), clamp = take_word(line, "-clamp");
        double value;
        if (clamp && take_word(line, "on"))
            made->wrap[0] = made->wrap[1] = WRAP_CLAMP;
        else if (!scale && !offset && !clamp)
        {
            *line += strcspn(*line, " \t");
            *line += strspn(*line, " \t");
        }
        for (size_t k = 0; k < 3 && take_number(line, &value); k++)
            if (k < 2 && (scale || offset))
                (scale ? made->scale : made->offset)[k] = value;
        if (!take_word(line, "on"))
            (void)take_word(line, "off");
    }
    made->offset[1] = 1 - made->scale[1] - made->offset[1]; // counted from the top
}

/// Read a statement about the colour of a material.
static bat_status read_statement(mesh_paints *paints, char *line, paint *made, bat_error *error)
{
    if (take_word(&line, "Kd") && made->image == SIZE_MAX && !made->vertices)
        for (size_t k = 0; k < 3; k++)
            made->factor[k] = take_number(&line, &made->factor[k]) ? decode(made->factor[k])
                              : k > 0                              ? made->factor[k - 1]
                                                                   : 1;
    if (paints->mesh->texture_faces == NULL || !take_word(&line, "map_Kd"))
        return BAT_OK;
    *made = (paint){.factor = {1, 1, 1}, .scale = {1, 1}};
    read_map_options(&line, made);
    for (char *at = strchr(line, '\\'); at != NULL; at = strchr(at, '\\'))
        *at = '/';
    return find_image(paints, line, &made->image, error);
}

/// Read the materials' file, which is in the folder of the mesh.
static bat_status read_mtl(mesh_paints *paints, bat_error *error)
{
    const bat_mesh *mesh = paints->mesh;
    const char *slash = strrchr(paints->path, '/');
    size_t folder = slash != NULL ? (size_t)(slash + 1 - paints->path) : 0, room = folder + strlen(mesh->material_files) + 1;
    char *path = malloc(room), *line = NULL, *name = NULL;
    size_t size = 0;
    if (path == NULL)
        return no_memory(error);
    (void)snprintf(path, room, "%.*s%s", (int)folder, paints->path, mesh->material_files);
    bool below = *mesh->material_files != '/' && strstr(mesh->material_files, "..") == NULL;
    FILE *file = below ? fopen(path, "r") : NULL;
    bat_status status = BAT_OK;
    if (file == NULL && mesh->texture_faces != NULL && !paints->colours)
        status = fail(error, BAT_FILE_ACCESS,
                      "its materials %.80s: %s; --bake needs them beside the mesh, or colours at its vertices",
                      mesh->material_files, below ? strerror(errno) : "not in its folder");
    while (file != NULL && status == BAT_OK && getline(&line, &size, file) >= 0)
    {
        char *at = line + strspn(line, " \t");
        for (size_t end = strlen(at); end > 0 && strchr(" \t\r\n", at[end - 1]) != NULL; end--)
            at[end - 1] = '\0';
        if (take_word(&at, "newmtl"))
        {
            free(name);
            name = strdup(at);
            continue;
        }
        for (size_t i = 0; i < mesh->label_count && status == BAT_OK && name != NULL; i++)
            if (mesh->labels[i].material != NULL && strcmp(mesh->labels[i].material, name) == 0)
                status = read_statement(paints, at, &paints->paints[i], error);
    }
    if (file != NULL)
        (void)fclose(file);
    free(path);
    free(line);
    free(name);
    return status;
}

/// Fill paints, which are all zero but for the mesh.
static bat_status fill(mesh_paints *paints, const json_t *root, bat_error *error)
{
    static const char *const names[] = {"red", "green", "blue"};
    const bat_mesh *mesh = paints->mesh;
    size_t found = 0;
    bat_status status = BAT_OK;
    for (size_t c = 0; c < mesh->channel_count; c++)
        for (size_t k = 0; k < 3; k++)
            if (strcmp(mesh->channel_names[c], names[k]) == 0)
            {
                paints->places[k] = c;
                found++;
            }
    paints->colours = found == 3;
    paints->linear = root != NULL;
    for (unsigned i = 0; i <= UINT8_MAX; i++)
        paints->light[i] = decode((double)i / UINT8_MAX);
    for (size_t i = 0; i < paints->count; i++)
        paints->paints[i] = (paint){.image = SIZE_MAX, .factor = {1, 1, 1}, .scale = {1, 1}, .vertices = paints->colours};
    for (size_t i = 0; i < mesh->label_count && root != NULL && status == BAT_OK; i++)
        status = read_material(paints, root, mesh->labels[i].material, &paints->paints[i], error);
    return root == NULL && mesh->material_files != NULL ? read_mtl(paints, error) : status;
}

/// Whether there is more than the vertices' colours.
static bool has_materials(const mesh_paints *paints)
{
    bool any = paints->linear && paints->colours; // which are linear light
    for (size_t i = 0; i < paints->count; i++)
        for (size_t k = 0; k < 3; k++)
            any = any || paints->paints[i].image != SIZE_MAX || paints->paints[i].factor[k] != 1;
    return any;
}

bat_status mesh_paints_read(const bat_mesh *mesh, const char *path, size_t size, mesh_paints **made, bat_error *error)
{
    mesh_paints *paints = calloc(1, sizeof *paints);
    size_t count = mesh->label_count > 0 ? mesh->label_count : 1;
    *made = NULL;
    if (paints == NULL)
        return no_memory(error);
    *paints = (mesh_paints){.mesh = mesh, .path = path, .count = count};
    paints->paints = calloc(count, sizeof *paints->paints);
    json_t *root = mesh->material_json != NULL ? json_loads(mesh->material_json, 0, NULL) : NULL;
    bool room = paints->paints != NULL && (mesh->material_json == NULL || root != NULL);
    bat_status status = room ? fill(paints, root, error) : no_memory(error);
    json_decref(root);
    if (status == BAT_OK && !halve_large(paints, size))
        status = no_memory(error);
    if (status == BAT_OK && has_materials(paints))
        *made = paints;
    else
        mesh_paints_free(paints);
    return status;
}

bool mesh_paints_reset(bat_mesh *mesh)
{
    json_t *root = mesh->material_json != NULL ? json_loads(mesh->material_json, 0, NULL) : NULL, *material;
    static const char *const unused[] = {"textures", "images", "samplers"};
    size_t i;
    json_array_foreach(json_object_get(root, "materials"), i, material)
    {
        json_t *base = json_object_get(material, "pbrMetallicRoughness"), *factor = json_object_get(base, "baseColorFactor");
        for (size_t k = 0; k < 3 && k < json_array_size(factor); k++)
            (void)json_array_set_new(factor, k, json_integer(1));
        (void)json_object_del(base, "baseColorTexture");
    }
    char *others = root != NULL ? json_dumps(json_object_get(root, "materials"), JSON_COMPACT) : NULL;
    for (i = 0; i < 3 && others != NULL && strstr(others, "exture\":{") == NULL; i++)
        (void)json_object_del(root, unused[i]);
    free(others);
    char *text = root != NULL ? json_dumps(root, JSON_COMPACT) : NULL;
    json_decref(root);
    if (text == NULL)
        return mesh->material_json == NULL;
    free(mesh->material_json);
    mesh->material_json = text;
    return true;
}
