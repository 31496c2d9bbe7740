#include "surface/network/surface_network_kind.h"

#include "surface/network/surface_chart_network.h"
#include "surface/network/surface_network.h"

#include <string.h>

static const surface_network_kind *const KINDS[] = {&surface_network_published, &surface_network_uninformed,
                                                    &surface_network_batten};
enum
{
    KIND_COUNT = sizeof KINDS / sizeof *KINDS
};

const surface_network_kind *surface_network_kind_named(const char *recipe)
{
    static const char FIRST[] = "surface ";
    if (recipe == NULL || strncmp(recipe, FIRST, sizeof FIRST - 1) != 0)
        return NULL;
    recipe += sizeof FIRST - 1;
    size_t length = strcspn(recipe, ",");
    for (size_t i = 0; i < KIND_COUNT; i++)
        if (strlen(KINDS[i]->name) == length && strncmp(KINDS[i]->name, recipe, length) == 0)
            return KINDS[i];
    return NULL;
}
