#include "research/train/surface_network_training.h"

typedef struct training_entry
{
    bat_surface_network network;
    bool uninformed;
    const surface_network_training *training;
} training_entry;

static const training_entry TRAININGS[] = {
    {BAT_SURFACE_PUBLISHED, false, &surface_training_published},
    {BAT_SURFACE_PUBLISHED, true, &surface_training_uninformed},
    {BAT_SURFACE_BATTEN, false, &surface_training_batten},
};

const surface_network_training *surface_network_training_of(bat_surface_network network, bool uninformed)
{
    for (size_t i = 0; i < sizeof TRAININGS / sizeof *TRAININGS; i++)
        if (TRAININGS[i].network == network && TRAININGS[i].uninformed == uninformed)
            return TRAININGS[i].training;
    return NULL;
}
