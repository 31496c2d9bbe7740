#include "io/gis/gdal.h"

#include "base/file_bytes.h"
#include "base/load_functions.h"
#include "curve/polygon.h"
#include "io/gis/gis.h"
#include "space/degrees.h"

#include <threads.h>

/// @file
/// Loading of GDAL's library, its messages, and its spelling of paths.

gdal_functions gdal;

static once_flag once = ONCE_FLAG_INIT;
static bool loaded;

static void load(void)
{
    static const char *const names[] = {
#define GDAL_NAME(name) #name,
        GDAL_FUNCTIONS(GDAL_NAME)
#undef GDAL_NAME
    };
    loaded = load_functions(BATTEN_GDAL_LIBRARY, names, sizeof names / sizeof *names, &gdal);
    if (loaded)
        gdal.GDALAllRegister();
}

static void collect(CPLErr kind, CPLErrorNum number BAT_UNUSED, const char *text)
{
    gdal_messages *messages = gdal.CPLGetErrorHandlerUserData();
    if (kind != CE_Failure && kind != CE_Fatal)
        return;
    if (messages->failures++ == 0)
        (void)snprintf(messages->text, sizeof messages->text, "%s", text);
}

bat_status gdal_begin(gdal_messages *messages, bat_error *error)
{
    *messages = (gdal_messages){.failures = 0};
    call_once(&once, load);
    if (!loaded)
        return ERROR_UNSUPPORTED(error, 0,
                                 "this needs GDAL, but " BATTEN_GDAL_LIBRARY
                                 " cannot be loaded: run scripts/install-deps, or "
                                 "install GDAL and build batten again");
    gdal.CPLPushErrorHandlerEx(collect, messages);
    return BAT_OK;
}

void gdal_end(void)
{
    gdal.CPLPopErrorHandler();
}

bat_status gdal_fault(const gdal_messages *messages, bat_status status, bat_error *error, const char *what)
{
    return error_set(error, status, BAT_NO_INDEX, 0, "%s%s%s", what, messages->failures > 0 ? ": " : "", messages->text);
}

char *gdal_path(const char *path)
{
    const char *dot = strrchr(path, '.'), *prefix = "";
    bool plain = strncmp(path, "/vsi", 4) != 0;
    if (plain && dot != NULL && strcasecmp(dot, ".gz") == 0)
        prefix = "/vsigzip/";
    else if (plain && dot != NULL && strcasecmp(dot, ".zip") == 0)
        prefix = "/vsizip/";
    else if (plain && dot != NULL && (strcasecmp(dot, ".gml") == 0 || strcasecmp(dot, ".xml") == 0))
        prefix = "/vsisubfile/0,"; // the whole file, and nothing can be written beside it
    size_t size = strlen(prefix) + strlen(path) + 1;
    char *spelled = malloc(size);
    if (spelled != NULL)
        (void)snprintf(spelled, size, "%s%s", prefix, path);
    return spelled;
}

bat_status gis_text_read(const char *path, const bat_limits *limits, file_text *text, bat_error *error)
{
    const bat_limits most = {.bytes = limits->bytes > 0 ? limits->bytes : (size_t)(FILE_MAX_BYTES - 1)};
    gdal_messages messages;
    bat_status status = gdal_begin(&messages, error);
    if (status != BAT_OK)
        return status;
    text_buffer bytes = {0};
    char *spelled = gdal_path(path);
    VSILFILE *file = spelled != NULL ? gdal.VSIFOpenL(spelled, "rb") : NULL;
    if (spelled == NULL)
        status = error_memory(error, strlen(path));
    else if (file == NULL)
        status = gdal_fault(&messages, BAT_FILE_ACCESS, error, "cannot read");
    for (size_t got = 1; status == BAT_OK && got > 0;)
    {
        static const size_t PIECE = 1 << 16;
        char *out = text_reserve(&bytes, PIECE);
        got = out != NULL ? gdal.VSIFReadL(out, 1, PIECE, file) : 0;
        if (out == NULL)
            status = error_memory(error, bytes.size + PIECE);
        else
            text_advance(&bytes, out + got);
        if (status == BAT_OK)
            status = file_text_bytes(&most, bytes.size, error);
    }
    if (status == BAT_OK && messages.failures > 0)
        status = gdal_fault(&messages, BAT_BAD_FILE, error, "cannot read");
    if (file != NULL)
        (void)gdal.VSIFCloseL(file);
    free(spelled);
    gdal_end();
    if (status == BAT_OK)
        status = file_text_copy(bytes.data != NULL ? bytes.data : "", bytes.size, limits, text, error);
    text_free(&bytes);
    return status;
}

// Coordinate systems and transformations between a projected plane and the sphere, by PROJ.

OGRSpatialReferenceH system_by_name(const char *name)
{
    OGRSpatialReferenceH system = gdal.OSRNewSpatialReference(NULL);
    if (system != NULL && gdal.OSRSetFromUserInput(system, name) != OGRERR_NONE)
    {
        gdal.OSRDestroySpatialReference(system);
        return NULL;
    }
    if (system != NULL)
        gdal.OSRSetAxisMappingStrategy(system, OAMS_TRADITIONAL_GIS_ORDER);
    return system;
}

char *system_name(OGRSpatialReferenceH system)
{
    const char *authority = gdal.OSRGetAuthorityName(system, NULL), *code = gdal.OSRGetAuthorityCode(system, NULL);
    char *name = NULL, *text = NULL;
    if (authority != NULL && code != NULL)
    {
        size_t size = strlen(authority) + strlen(code) + sizeof ":";
        name = malloc(size);
        if (name != NULL)
            (void)snprintf(name, size, "%s:%s", authority, code);
        return name;
    }
    static const char *const options[] = {"FORMAT=WKT2", NULL};
    if (gdal.OSRExportToWktEx(system, &text, options) == OGRERR_NONE && text != NULL)
        name = strdup(text);
    gdal.VSIFree(text);
    return name;
}

bool system_is_degrees(OGRSpatialReferenceH system)
{
    static const double DEGREE = 0.017453292519943295769, ACCURACY = 1e-12;
    return gdal.OSRIsGeographic(system) != 0 && fabs(gdal.OSRGetAngularUnits(system, NULL) - DEGREE) < ACCURACY &&
           gdal.OSRGetPrimeMeridian(system, NULL) == 0;
}

bool system_is_swapped(OGRSpatialReferenceH system)
{
    int count = 0, usual_count = 0;
    OGRSpatialReferenceH usual = gdal.OSRClone(system);
    gdal.OSRSetAxisMappingStrategy(usual, OAMS_TRADITIONAL_GIS_ORDER);
    const int *axes = gdal.OSRGetDataAxisToSRSAxisMapping(system, &count);
    const int *usual_axes = gdal.OSRGetDataAxisToSRSAxisMapping(usual, &usual_count);
    bool swapped = count >= 2 && usual_count >= 2 && axes[0] == usual_axes[1] && axes[1] == usual_axes[0];
    gdal.OSRDestroySpatialReference(usual);
    return swapped;
}

/// The transformation between a plane and longitude and latitude in degrees: on the ellipsoid of the plane's system where
/// possible, because that is the same point of the Earth and comes back exactly; else WGS 84.
static OGRCoordinateTransformationH transformation(const char *name, gis_target target)
{
    OGRSpatialReferenceH plane = system_by_name(name);
    bool to_sphere = target != GIS_PLANE;
    if (plane == NULL)
        return NULL;
    OGRSpatialReferenceH globe = target != GIS_WGS84 ? gdal.OSRCloneGeogCS(plane) : NULL;
    if (globe != NULL && !system_is_degrees(globe))
    {
        gdal.OSRDestroySpatialReference(globe);
        globe = NULL;
    }
    if (globe == NULL)
        globe = system_by_name("OGC:CRS84");
    OGRCoordinateTransformationH result = NULL;
    if (globe != NULL)
    {
        gdal.OSRSetAxisMappingStrategy(globe, OAMS_TRADITIONAL_GIS_ORDER);
        result = gdal.OCTNewCoordinateTransformation(to_sphere ? plane : globe, to_sphere ? globe : plane);
        gdal.OSRDestroySpatialReference(globe);
    }
    gdal.OSRDestroySpatialReference(plane);
    return result;
}

/// Copy a curve, with room for the points of another space.
static bool copy_curve(const bat_curve *curve, const bat_space *space, bat_curve *copy)
{
    const bat_curve like = {.space = space, .closed = curve->closed, .channel_count = curve->channel_count};
    if (curve_room(&like, curve->count, curve->corners != NULL, copy, NULL) != BAT_OK)
        return false;
    if (copy->channels != NULL && curve->channels != NULL)
        memcpy(copy->channels, curve->channels, curve->count * curve->channel_count * sizeof *copy->channels);
    if (copy->corners != NULL && curve->corners != NULL)
        memcpy(copy->corners, curve->corners, curve->count);
    return true;
}

/// Transform the points of a curve into those of its copy.
static bat_status transform_curve(OGRCoordinateTransformationH transform, const bat_curve *curve, bat_curve *copy,
                                  bat_error *error)
{
    bool from_plane = curve->space->point_dim == 2, to_sphere = copy->space->point_dim == 3;
    static const double DEGREES = 57.295779513082320876798154814105;
    double *x = memory_array(curve->count, 2 * sizeof *x), *y = x + curve->count;
    int *done = memory_array(curve->count, sizeof *done);
    bat_status status = x != NULL && done != NULL ? BAT_OK : error_memory(error, curve->count * sizeof *x);
    for (size_t i = 0; i < curve->count && status == BAT_OK; i++)
    {
        const double *point = curve->points + i * curve->space->point_dim;
        x[i] = from_plane ? point[0] : atan2(point[1], point[0]) * DEGREES;
        y[i] = from_plane ? point[1] : atan2(point[2], hypot(point[0], point[1])) * DEGREES;
    }
    if (status == BAT_OK)
        (void)gdal.OCTTransformEx(transform, (int)curve->count, x, y, NULL, done);
    for (size_t i = 0; i < curve->count && status == BAT_OK; i++)
    {
        double *point = copy->points + i * copy->space->point_dim;
        if (!done[i] || !isfinite(x[i]) || !isfinite(y[i]) || (to_sphere && degrees_fault(x[i], y[i]) != NULL))
            status = error_set(error, BAT_INVALID_POINT, i, 0, "point %zu has no place in the coordinate system", i);
        else if (to_sphere)
            degrees_to_point(x[i], y[i], point);
        else
        {
            point[0] = x[i];
            point[1] = y[i];
        }
    }
    free(x);
    free(done);
    return status;
}

bat_status gis_transform(const bat_curve_set *set, const char *crs, gis_target target, bat_curve_set *result,
                         bat_error *error)
{
    gdal_messages messages;
    bat_status status = gdal_begin(&messages, error);
    if (status != BAT_OK)
        return status;
    bat_curve_set moved = {.space = malloc(sizeof *moved.space), .curves = calloc(set->count, sizeof *moved.curves)};
    OGRCoordinateTransformationH transform = transformation(crs, target);
    if (moved.space == NULL || moved.curves == NULL)
        status = error_memory(error, set->count * sizeof *moved.curves);
    else if (transform == NULL)
        status = gdal_fault(&messages, BAT_UNSUPPORTED, error, "the coordinate system cannot be transformed");
    if (status == BAT_OK)
        *moved.space = target != GIS_PLANE ? bat_sphere(2) : bat_euclidean(2);
    for (; status == BAT_OK && moved.count < set->count; moved.count++)
        status = copy_curve(&set->curves[moved.count], moved.space, &moved.curves[moved.count])
                     ? transform_curve(transform, &set->curves[moved.count], &moved.curves[moved.count], error)
                     : error_memory(error, set->curves[moved.count].count * sizeof(double));
    if (transform != NULL)
        gdal.OCTDestroyCoordinateTransformation(transform);
    gdal_end();
    if (status != BAT_OK)
    {
        bat_curve_set_free(&moved);
        return status;
    }
    moved.attributes = set->attributes;
    attributes_share(moved.attributes);
    *result = moved;
    return BAT_OK;
}

bat_status gis_to_sphere(bat_curve_set *set, bat_error *error)
{
    if (set->space->point_dim != 2)
        return BAT_OK;
    if (set->attributes == NULL || set->attributes->crs == NULL)
        return ERROR_ARGUMENT(error, "the file names no coordinate system, so its points cannot go to the sphere");
    bat_curve_set moved;
    bat_status status = gis_transform(set, set->attributes->crs, GIS_SPHERE, &moved, error);
    if (status != BAT_OK)
        return status;
    bat_curve_set_free(set);
    *set = moved;
    set->attributes->on_sphere = true;
    return BAT_OK;
}
