#include "base/core/disjoint_sets.hpp"

#include <doctest/doctest.h>

using namespace pliant;

TEST_CASE("sets are named by their smallest element, in whatever order they are joined") {
    DisjointSets sets(6);
    sets.join(5, 3);
    sets.join(4, 1);
    CHECK(sets.find(5) == 3);
    CHECK(sets.find(4) == 1);
    sets.join(5, 4);
    sets.join(3, 1);
    for (const int i : {1, 3, 4, 5}) CHECK(sets.find(i) == 1);
    CHECK(sets.find(0) == 0);
    CHECK(sets.find(2) == 2);
}
