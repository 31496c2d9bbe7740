#include "mesh/channels.h"

#include "base/error.h"
#include "base/memory.h"

bat_status channels_make(const bat_mesh *from, size_t vertices, bat_mesh *to, bat_error *error)
{
    bat_mesh names = {.channel_names = from->channel_names, .channel_count = from->channel_count}, copy;
    bat_status status = bat_mesh_copy(&names, &copy, error);
    if (status != BAT_OK)
        return status;
    to->channel_names = copy.channel_names;
    to->channel_count = copy.channel_count;
    to->channels = memory_array(vertices, from->channel_count * sizeof *to->channels);
    return to->channels != NULL ? BAT_OK : error_memory(error, vertices * from->channel_count * sizeof *to->channels);
}
