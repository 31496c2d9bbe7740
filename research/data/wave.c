#include "research/data/wave.h"

harmonics harmonics_draw(bat_random *random, int count, double decay)
{
    harmonics h = {.count = count};
    for (int k = 0; k < count; k++)
    {
        double deviation = pow(k + 1, -decay);
        h.cosine[k] = deviation * bat_random_normal(random);
        h.sine[k] = deviation * bat_random_normal(random);
    }
    return h;
}

harmonics harmonics_draw_phased(bat_random *random, int count, double decay)
{
    harmonics h = {.count = count};
    for (int k = 0; k < count; k++)
    {
        double amplitude = pow(k + 1, -decay) * bat_random_normal(random), phase = draw_angle(random);
        h.cosine[k] = amplitude * cos(phase);
        h.sine[k] = -amplitude * sin(phase);
    }
    return h;
}

void harmonics_limit(harmonics *h, double bound)
{
    double sum = 0;
    for (int k = 0; k < h->count; k++)
        sum += hypot(h->cosine[k], h->sine[k]);
    double scale = sum > bound ? bound / sum : 1;
    for (int k = 0; k < h->count; k++)
    {
        h->cosine[k] *= scale;
        h->sine[k] *= scale;
    }
}
