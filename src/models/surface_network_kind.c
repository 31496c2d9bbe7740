#include "models/surface_network_kind.h"

#include "models/surface_chart_network.h"
#include "models/surface_network.h"

#include <string.h>

typedef struct kind_entry
{
    bat_surface_network network;
    bool uninformed;
    const surface_network_kind *kind;
} kind_entry;

static const kind_entry KINDS[] = {
    {BAT_SURFACE_PUBLISHED, false, &surface_network_published},
    {BAT_SURFACE_PUBLISHED, true, &surface_network_uninformed},
    {BAT_SURFACE_BATTEN, false, &surface_network_batten},
};
enum
{
    KIND_COUNT = sizeof KINDS / sizeof *KINDS
};

const surface_network_kind *surface_network_kind_of(bat_surface_network network, bool uninformed)
{
    for (size_t i = 0; i < KIND_COUNT; i++)
        if (KINDS[i].network == network && KINDS[i].uninformed == uninformed)
            return KINDS[i].kind;
    return NULL;
}

const surface_network_kind *surface_network_kind_named(const char *recipe)
{
    static const char FIRST[] = "surface ";
    if (recipe == NULL || strncmp(recipe, FIRST, sizeof FIRST - 1) != 0)
        return NULL;
    recipe += sizeof FIRST - 1;
    size_t length = strcspn(recipe, ",");
    for (size_t i = 0; i < KIND_COUNT; i++)
        if (strlen(KINDS[i].kind->name) == length && strncmp(KINDS[i].kind->name, recipe, length) == 0)
            return KINDS[i].kind;
    return NULL;
}
