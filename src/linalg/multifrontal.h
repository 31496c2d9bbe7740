#pragma once

#include "base/bisect.h"
#include "base/memory.h"

/// @file
/// The symbolic part of the multifrontal method (Liu, "The multifrontal method for sparse matrix solution: theory and
/// practice", 1992): an order of elimination with little fill, and the tree of fronts. A front is a dense matrix of
/// consecutive pivots and of the later rows that these pivots change. Its children are the fronts that change it first.

/// A sparse matrix of a symmetric pattern, as its lower triangle by columns.
typedef struct symmetric_pattern
{
    size_t count;     ///< unknowns
    const int *first; ///< [count + 1]
    const int *row;   ///< rows of each column, each once: the diagonal first, then rows below it
} symmetric_pattern;

/// The index of an entry that such a pattern has, in the column of its lesser unknown.
static inline size_t symmetric_pattern_find(const int *first, const int *row, size_t i, size_t j)
{
    size_t column = i < j ? i : j, wanted = i < j ? j : i;
    size_t low = (size_t)first[column], high = (size_t)first[column + 1];
    BISECT(low, high, middle, (size_t)row[middle] < wanted)
    return low;
}

/// An entry of the matrix in the column of its earlier unknown.
typedef struct front_entry
{
    int row;    ///< the place of the later unknown
    int source; ///< the entry's index in the pattern; the complement of it where the order of elimination swaps the two
                ///< unknowns
} front_entry;

/// Release it with front_tree_free(). Places are positions in the order of elimination.
typedef struct front_tree
{
    size_t count;         ///< unknowns
    size_t fronts;        ///< children come before their parent, all that is below one child before the next
    int *order;           ///< [count] the unknown at each place
    int *diagonal;        ///< [count] the index in the pattern of each place's diagonal entry
    size_t *entry_first;  ///< [count + 1]
    front_entry *entries; ///< of each place: the diagonal and the entries with later unknowns
    int *pivot_first;     ///< [fronts + 1] places
    int *children;        ///< [fronts] how many
    size_t *row_first;    ///< [fronts + 1]
    int *rows;            ///< places that the pivots of a front change, after those pivots, rising
    size_t *panel_first;  ///< [fronts + 1] sums of rows times pivots, the pivots' own rows among the rows
    size_t panel_max;     ///< rows of the largest front, its pivots among them
    size_t update_max;    ///< the largest sum of squared numbers of rows over the fronts whose parents are to come
    memory_pool pool;     ///< of all arrays
} front_tree;

/// Order the unknowns by approximate minimum degree (Amestoy, Davis and Duff, 2004) and find the fronts.
/// @return BAT_OK, BAT_NO_MEMORY
bat_status front_tree_make(const symmetric_pattern *pattern, front_tree *tree, bat_error *error);
void front_tree_free(front_tree *tree);

// Direct solution of sparse linear systems by the multifrontal method (Duff and Reid, 1983; Liu, 1992). The factorization
// is A = L U, where L and U^T have the same diagonal, without pivoting. It exists in any order of elimination for symmetric
// positive definite matrices, where U = L^T, and for nonsingular M-matrices. For matrices that are diagonally dominant by
// rows, its growth factor is at most 2 (Higham, 2002, chapter 9).

typedef struct multifrontal multifrontal;

/// Analyse a pattern and allocate the factors. The pattern may be released afterwards.
/// @param symmetric whether the matrix is symmetric and not its pattern alone
/// @return BAT_OK, BAT_NO_MEMORY
bat_status multifrontal_make(const symmetric_pattern *pattern, bool symmetric, multifrontal **solver, bat_error *error);
/// Does nothing to null.
void multifrontal_free(multifrontal *solver);

/// Factor a matrix on the calling thread. There are no factors where the least pivot is 0.
/// @param lower the entries of the pattern
/// @param upper the entries on the other side of the diagonal; null: those of `lower`, for a symmetric matrix
/// @param pivot receives the least pivot over the diagonal entry that it came from; 0 where a pivot is not above 0
/// @return BAT_OK, BAT_NO_MEMORY
bat_status multifrontal_factor(multifrontal *solver, const double *lower, const double *upper, double *pivot,
                               bat_error *error);

/// Solve A x = b on the calling thread. The factors must exist.
/// @param x [count x columns] b, receives x
/// @return BAT_OK, BAT_NO_MEMORY
bat_status multifrontal_solve(const multifrontal *solver, size_t columns, double *x, bat_error *error);
