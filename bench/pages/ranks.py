# SPDX-License-Identifier: Apache-2.0
# Rank correlation.
from statistics import correlation


def average_ranks(values):
    """From 1 for the smallest; equal values share the mean of their ranks."""
    return [sum(y < x for y in values) + 0.5 * (sum(y == x for y in values) + 1) for x in values]


def spearman(a, b):
    """Spearman's rho of two lists of equal length: the correlation of their ranks, from -1 to 1. None for
    fewer than three pairs, and where all values of a list are equal."""
    if len(a) < 3 or len(set(a)) == 1 or len(set(b)) == 1:
        return None
    return correlation(average_ranks(a), average_ranks(b))
