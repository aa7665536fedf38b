#include "mesh/solid.hpp"

#include <doctest/doctest.h>

using namespace pliant;
using namespace pliant::mesh;

namespace {

/// Reads `geometry = TEXT` with the named shapes of `shapes`; the problems, or "".
std::string read(const std::string& text, Solid& solid, const std::string& shapes = "") {
    const auto document = config::parse("geometry = " + text + "\n" + shapes, "r.toml");
    REQUIRE_MESSAGE(document, (document ? "" : document.error().message));
    config::Problems problems("r.toml");
    config::Reader root(document->root, problems);
    NamedShapes named;
    if (const config::Value* table = root.raw("shape")) {
        for (const auto& [name, value] : std::get<config::Table>(table->data)) named.emplace_back(name, &value);
    }
    solid = read_solid(*root.raw("geometry"), "geometry", named, problems);
    const Status status = problems.status();
    return status ? "" : status.error().message;
}

bool inside(const std::string& text, const Vec3& p, const std::string& shapes = "") {
    Solid solid;
    const std::string problem = read(text, solid, shapes);
    REQUIRE_MESSAGE(problem.empty(), problem);
    return contains(solid, p);
}

}  // namespace

TEST_CASE("membership of every shape") {
    CHECK(inside("{ box = [[0,0,0],[1,2,3]] }", {0.5, 1.9, 2.9}));
    CHECK_FALSE(inside("{ box = [[0,0,0],[1,2,3]] }", {0.5, 2.1, 2.9}));
    CHECK(inside("{ sphere = { center = [1,1,1], radius = 2 } }", {1, 1, 2.9}));
    CHECK_FALSE(inside("{ sphere = { center = [1,1,1], radius = 2 } }", {2.5, 2.5, 2.5}));
    CHECK(inside("{ cylinder = { from = [0,0,0], to = [0,0,5], radius = 1 } }", {0.6, 0.6, 4.9}));
    CHECK_FALSE(inside("{ cylinder = { from = [0,0,0], to = [0,0,5], radius = 1 } }", {0, 0, 5.1}));
    CHECK(inside("{ prism = [[0,0],[4,0],[0,3]], plane = \"xz\", from = 0, to = 1 }", {1, 0.5, 1}));
    CHECK_FALSE(inside("{ prism = [[0,0],[4,0],[0,3]], plane = \"xz\", from = 0, to = 1 }", {3, 0.5, 2}));
    CHECK(inside("{ prism = [[0,0],[4,0],[0,3]], plane = \"yz\", from = 7, to = 8 }", {7.5, 1, 1}));
    CHECK_FALSE(inside("{ difference = [{ box = [[0,0,0],[2,2,2]] }, { box = [[0,0,0],[1,1,1]] }] }", {0.5, 0.5, 0.5}));
    CHECK(inside("{ union = [{ box = [[0,0,0],[1,1,1]] }, { box = [[4,0,0],[5,1,1]] }] }", {4.5, 0.5, 0.5}));
    CHECK_FALSE(
        inside("{ intersection = [{ box = [[0,0,0],[2,2,2]] }, { box = [[1,1,1],[3,3,3]] }] }", {0.5, 0.5, 0.5}));
    CHECK(inside("{ translate = [10,0,0], of = { box = [[0,0,0],[1,1,1]] } }", {10.5, 0.5, 0.5}));
    CHECK(inside("{ rotate = 90, axis = [0,0,1], of = { box = [[0,0,0],[2,1,1]] } }", {-0.5, 1.5, 0.5}));
    CHECK(inside("{ repeat = 3, step = [5,0,0], of = { box = [[0,0,0],[1,1,1]] } }", {10.5, 0.5, 0.5}));
    CHECK_FALSE(inside("{ repeat = 3, step = [5,0,0], of = { box = [[0,0,0],[1,1,1]] } }", {15.5, 0.5, 0.5}));
    CHECK(inside("{ use = \"cube\" }", {0.5, 0.5, 0.5}, "[shape.cube]\nbox = [[0,0,0],[1,1,1]]\n"));
}

TEST_CASE("bounds hold the solid") {
    Solid solid;
    REQUIRE(read("{ repeat = 3, step = [5,0,0], of = { rotate = 90, axis = [0,0,1], of = { cylinder = { from = "
                 "[0,0,0], to = [3,0,0], radius = 1 } } } }",
                 solid)
                .empty());
    const Box3 box = bounds(solid);
    CHECK(box.low.x <= -1);
    CHECK(box.high.x >= 11);
    CHECK(box.high.y >= 3);
}

TEST_CASE("a shape that uses itself, or that doubles at every level, ends in a message") {
    Solid solid;
    CHECK(
        read("{ use = \"a\" }", solid, "[shape.a]\nunion = [{ use = \"a\" }, { use = \"a\" }]\n").find("uses itself") !=
        std::string::npos);
    std::string shapes = "[shape.s0]\nbox = [[0,0,0],[1,1,1]]\n";
    for (int i = 1; i < 30; ++i) {
        const std::string before = std::to_string(i - 1);
        shapes += "[shape.s" + std::to_string(i) + "]\nunion = [{ use = \"s" + before + "\" }, { use = \"s" + before +
                  "\" }]\n";
    }
    CHECK(read("{ use = \"s29\" }", solid, shapes).find("too many shapes") != std::string::npos);
}
