#include "io/curve/crs_name.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/// What follows `prefix` in either case; null when the text begins differently.
static const char *after(const char *text, const char *prefix)
{
    size_t length = strlen(prefix);
    return strncasecmp(text, prefix, length) == 0 ? text + length : NULL;
}

/// What follows the last separator of a name after a prefix: the code, after a version.
static const char *code_of(const char *name)
{
    static const struct
    {
        const char *prefix;
        char separator;
    } forms[] = {{"urn:ogc:def:crs:EPSG:", ':'},
                 {"urn:x-ogc:def:crs:EPSG:", ':'},
                 {"EPSG:", ':'},
                 {"http://www.opengis.net/def/crs/EPSG/", '/'},
                 {"https://www.opengis.net/def/crs/EPSG/", '/'},
                 {"http://www.opengis.net/gml/srs/epsg.xml#", '#'}};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
    {
        if (after(name, forms[i].prefix) == NULL)
            continue;
        const char *code = strrchr(name, forms[i].separator) + 1;
        size_t digits = strspn(code, "0123456789");
        return digits > 0 && code[digits] == '\0' ? code : NULL;
    }
    return NULL;
}

char *crs_short_name(const char *name)
{
    static const char *const global[] = {"urn:ogc:def:crs:OGC:1.3:CRS84",
                                         "urn:ogc:def:crs:OGC::CRS84",
                                         "urn:ogc:def:crs:OGC:2:84",
                                         "http://www.opengis.net/def/crs/OGC/1.3/CRS84",
                                         "https://www.opengis.net/def/crs/OGC/1.3/CRS84",
                                         "OGC:CRS84",
                                         "CRS:84",
                                         "CRS84"};
    for (size_t i = 0; i < sizeof global / sizeof *global; i++)
        if (strcasecmp(name, global[i]) == 0)
            return strdup("OGC:CRS84");
    const char *code = code_of(name);
    if (code == NULL)
        return strdup(name);
    size_t size = strlen(code) + sizeof "EPSG:";
    char *text = malloc(size);
    if (text != NULL)
        (void)snprintf(text, size, "EPSG:%s", code);
    return text;
}

bool crs_is_default(const char *short_name)
{
    return strcmp(short_name, "OGC:CRS84") == 0 || strcmp(short_name, "EPSG:4326") == 0 ||
           strcmp(short_name, "EPSG:4979") == 0;
}

bool crs_is_geographic(const char *short_name)
{
    static const char *const others[] = {"EPSG:4258", "EPSG:4269", "EPSG:4283", "EPSG:7844",
                                         "EPSG:6668", "EPSG:4490", "EPSG:4167"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(short_name, others[i]) == 0)
            return true;
    return crs_is_default(short_name);
}

void crs_urn(const char *short_name, char *text, unsigned long size)
{
    const char *code = after(short_name, "EPSG:");
    (void)snprintf(text, size, "%s%s", code != NULL ? "urn:ogc:def:crs:EPSG::" : "", code != NULL ? code : short_name);
}
