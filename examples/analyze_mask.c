// How smooth the curves of a subdivision mask are, with proof.
//
//     cc analyze_mask.c $(pkg-config --cflags --libs batten) -lm && ./a.out mask:-1/16,0,9/16,1,9/16,0,-1/16
//
// Without an argument: Chaikin's corner cutting, whose limits are quadratic splines.

#include <batten/batten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void print_mask(const char *title, const bat_mask *mask)
{
    printf("%-18s", title);
    for (size_t k = 0; k < mask->count; k++)
        printf(" %.6g", mask->coefficients[k]);
    putchar('\n');
}

static void print_analysis(const bat_analysis *analysis)
{
    print_mask("mask", &analysis->mask);
    printf("%-18s (1 + z)^%zu times\n", "symbol", analysis->multiplicity);
    print_mask("", &analysis->quotient);
    printf("%-18s", "eigenvalues");
    for (size_t k = 0; k < analysis->eigenvalue_count; k++)
        if (analysis->eigenvalues[k].imaginary == 0)
            printf(" %.6g", analysis->eigenvalues[k].real);
        else
            printf(" %.6g%+.6gi", analysis->eigenvalues[k].real, analysis->eigenvalues[k].imaginary);
    printf("\n%-18s %s\n", "converges", bat_choice_name(&bat_analysis_verdict_family, analysis->converges));
    printf("%-18s %zu\n", "reproduces degree", analysis->reproduction_degree);
    if (analysis->smooth_proven >= 0)
        printf("%-18s C%d, Hölder exponent from %.9g to %.9g\n", "limits", analysis->smooth_proven, analysis->exponent_lower,
               analysis->exponent_upper);
}

/// Chaikin's limits are piecewise quadratic: C1, and their first derivative is Lipschitz continuous but no better.
static bool is_right_for_chaikin(const bat_analysis *analysis)
{
    return analysis->converges == BAT_ANALYSIS_VERDICT_PROVEN && analysis->smooth_proven == 1 &&
           analysis->smooth_disproven == 2 && fabs(analysis->exponent_lower - 2) < 1e-9 &&
           fabs(analysis->exponent_upper - 2) < 1e-9;
}

int main(int argc, char **argv)
{
    bat_error error;
    bat_curve_scheme scheme;
    bat_analysis analysis;
    if (bat_curve_scheme_by_name(argc > 1 ? argv[1] : "chaikin", &scheme, &error) != BAT_OK)
    {
        fprintf(stderr, "analyze_mask: %s\n", error.text);
        return EXIT_FAILURE;
    }
    if (scheme.kind != BAT_CURVE_SCHEME_KIND_LINEAR)
    {
        fputs("analyze_mask: only a linear scheme has a mask to analyze\n", stderr);
        return EXIT_FAILURE;
    }
    if (bat_mask_analyze(&scheme.mask, NULL, &analysis, &error) != BAT_OK)
    {
        fprintf(stderr, "analyze_mask: %s\n", error.text);
        return EXIT_FAILURE;
    }
    print_analysis(&analysis);
    bool good = argc > 1 || is_right_for_chaikin(&analysis);
    bat_analysis_free(&analysis);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
