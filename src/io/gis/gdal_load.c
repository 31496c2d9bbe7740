#include "io/gis/gdal.h"

#include "base/error.h"
#include "io/gis/gis.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
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
    void *library = dlopen(BATTEN_GDAL_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    if (library == NULL)
        return;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    {
        void *function = dlsym(library, names[i]);
        if (function == NULL)
            return;
        // All pointers to functions have one size in POSIX.
        memcpy((char *)&gdal + i * sizeof function, &function, sizeof function);
    }
    gdal.GDALAllRegister();
    loaded = true;
}

static void collect(CPLErr kind, CPLErrorNum number, const char *text)
{
    gdal_messages *messages = gdal.CPLGetErrorHandlerUserData();
    (void)number;
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
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                         "this needs GDAL, but " BATTEN_GDAL_LIBRARY " cannot be loaded: run scripts/install-deps, or "
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
    if (messages->failures == 0)
        return error_set(error, status, BAT_NO_INDEX, 0, "%s", what);
    return error_set(error, status, BAT_NO_INDEX, 0, "%s: %s", what, messages->text);
}

char *gdal_path(const char *path)
{
    const char *dot = strrchr(path, '.'), *prefix = "";
    bool plain = strncmp(path, "/vsi", 4) != 0;
    if (plain && dot != NULL && strcasecmp(dot, ".gz") == 0)
        prefix = "/vsigzip/";
    else if (plain && dot != NULL && strcasecmp(dot, ".zip") == 0)
        prefix = "/vsizip/";
    size_t size = strlen(prefix) + strlen(path) + 1;
    char *spelled = malloc(size);
    if (spelled != NULL)
        (void)snprintf(spelled, size, "%s%s", prefix, path);
    return spelled;
}

bat_status gis_text_read(const char *path, file_text *text, bat_error *error)
{
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
    }
    if (status == BAT_OK && messages.failures > 0)
        status = gdal_fault(&messages, BAT_BAD_FILE, error, "cannot read");
    if (file != NULL)
        (void)gdal.VSIFCloseL(file);
    free(spelled);
    gdal_end();
    if (status == BAT_OK)
        status = file_text_copy(bytes.data != NULL ? bytes.data : "", bytes.size, NULL, text, error);
    text_free(&bytes);
    return status;
}
