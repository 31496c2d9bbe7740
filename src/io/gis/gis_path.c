#include "io/gis/gis.h"

#include <string.h>
#include <strings.h>

/// @file
/// Paths that only GDAL opens.

bool gis_is_virtual(const char *path)
{
    static const char ENDING[] = ".gz";
    size_t length = strlen(path), size = sizeof ENDING - 1;
    return strncmp(path, "/vsi", 4) == 0 || (length > size && strcasecmp(path + length - size, ENDING) == 0);
}
