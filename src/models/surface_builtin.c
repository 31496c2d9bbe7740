#include "batten/surface_model.h"

#include "base/error.h"

bat_status bat_surface_model_builtin(bat_surface_model **model, bat_error *error)
{
    (void)model;
    return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "no weights come with this build");
}
