#include "research/train/train_model.h"

#include <stdio.h>

bat_status train_model_write(const char *path, const learn_parameters *parameters, const char *recipe, uint64_t seed,
                             const learn_report *made, const char *watched, bat_error *error)
{
    char seed_text[32], epochs[32], best_epoch[32], best[32];
    (void)snprintf(seed_text, sizeof seed_text, "%llu", (unsigned long long)seed);
    (void)snprintf(epochs, sizeof epochs, "%llu", (unsigned long long)made->epochs);
    (void)snprintf(best_epoch, sizeof best_epoch, "%llu", (unsigned long long)made->best_epoch + 1);
    (void)snprintf(best, sizeof best, "%.6g", made->best);
    const safetensors_note notes[] = {
        {"recipe", recipe}, {"seed", seed_text}, {"epochs", epochs}, {"best_epoch", best_epoch}, {watched, best}};
    return learn_parameters_write(parameters, path, notes, sizeof notes / sizeof *notes, error);
}
