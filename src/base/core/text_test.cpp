#include "base/core/text.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "base/core/counted.hpp"

using namespace pliant;

TEST_CASE("edit distance counts single-character changes") {
    CHECK(edit_distance("", "abc") == 3);
    CHECK(edit_distance("kitten", "sitting") == 3);
    CHECK(edit_distance("same", "same") == 0);
}

TEST_CASE("the nearest name is offered only when it is near") {
    const std::vector<std::string> names = {"geometry", "material", "name"};
    CHECK(nearest_name("geometri", names) == "geometry");
    CHECK(nearest_name("matrial", names) == "material");
    CHECK(nearest_name("xyzzyplugh", names).empty());
}

TEST_CASE("a count of one is singular") {
    CHECK(counted(0, "swap") == "0 swaps");
    CHECK(counted(1, "swap") == "1 swap");
    CHECK(counted(2, "swap") == "2 swaps");
}

TEST_CASE("names are joined with commas and 'and'") {
    CHECK(join_names(std::vector<std::string>{}).empty());
    CHECK(join_names(std::vector<std::string>{"a"}) == "a");
    CHECK(join_names(std::vector<std::string>{"a", "b", "c"}) == "a, b and c");
}
