#include "geometry/shapes/solid.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace pliant;
using namespace pliant::mesh;

namespace {

/// Parses `geometry = TEXT` with the named shapes of `shapes`; returns the problems, or "".
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

TEST_CASE("every shape tells whether a point is inside") {
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

TEST_CASE("bounds contain the solid") {
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

TEST_CASE("bounds of simple shapes are the smallest box, also turned") {
    struct Row {
        const char* text;
        Vec3 low, high;
    };
    const double h = std::sqrt(0.5);
    for (const Row& row : {
             Row{"{ cylinder = { from = [0,0,0], to = [0,0,9], radius = 2 } }", {-2, -2, 0}, {2, 2, 9}},
             Row{"{ cylinder = { from = [0,0,1], to = [4,0,5], radius = 2 } }",
                 {-2 * h, -2, 1 - 2 * h},
                 {4 + 2 * h, 2, 5 + 2 * h}},
             Row{"{ rotate = 45, axis = [0,1,0], of = { cylinder = { from = [0,0,0], to = [0,0,9], radius = 2 } } }",
                 {-2 * h, -2, -2 * h},
                 {11 * h, 2, 11 * h}},
             Row{"{ rotate = 45, axis = [0,0,1], of = { sphere = { center = [0,0,0], radius = 3 } } }",
                 {-3, -3, -3},
                 {3, 3, 3}},
             Row{"{ rotate = 45, axis = [0,0,3], of = { rotate = 45, axis = [0,0,1], of = { box = [[0,0,0],[4,2,1]] } "
                 "} }",
                 {-2, 0, 0},
                 {0, 4, 1}},
             Row{"{ rotate = 90, axis = [0,0,1], center = [5,0,0], of = { translate = [0,0,7], of = { union = [{ box = "
                 "[[0,0,0],[4,2,1]] }, { sphere = { center = [0,0,0], radius = 1 } }] } } }",
                 {3, -6, 6},
                 {6, -1, 8}},
             Row{"{ rotate = 90, axis = [1,0,0], of = { repeat = 3, step = [0,5,0], of = { prism = "
                 "[[0,0],[4,0],[0,3]], "
                 "from = 0, to = 1 } } }",
                 {0, -1, 0},
                 {4, 0, 13}},
             Row{"{ rotate = 45, axis = [0,0,1], of = { intersection = [{ box = [[-9,-1,0],[9,1,1]] }, { box = "
                 "[[-1,-9,0],[1,9,1]] }] } }",
                 {-2 * h, -2 * h, 0},
                 {2 * h, 2 * h, 1}},
             Row{"{ rotate = 45, axis = [0,0,1], of = { difference = [{ box = [[0,0,0],[2,2,1]] }, { sphere = { center "
                 "= [9,9,9], radius = 1 } }] } }",
                 {-2 * h, 0, 0},
                 {2 * h, 4 * h, 1}},
         }) {
        CAPTURE(row.text);
        Solid solid;
        REQUIRE(read(row.text, solid).empty());
        const Box3 box = bounds(solid);
        CHECK(norm(box.low - row.low) < 1e-12);
        CHECK(norm(box.high - row.high) < 1e-12);
    }
}

TEST_CASE("a shape that uses itself, or doubles at every level, is refused") {
    Solid solid;
    CHECK(
        read("{ use = \"a\" }", solid, "[shape.a]\nunion = [{ use = \"a\" }, { use = \"a\" }]\n").find("uses itself") !=
        std::string::npos);
    std::string shapes = "[shape.s0]\nbox = [[0,0,0],[1,1,1]]\n";
    for (int i = 1; i < 16; ++i) {
        const std::string before = std::to_string(i - 1);
        shapes += "[shape.s" + std::to_string(i) + "]\nunion = [{ use = \"s" + before + "\" }, { use = \"s" + before +
                  "\" }]\n";
    }
    CHECK(read("{ use = \"s15\" }", solid, shapes).find("too many shapes") != std::string::npos);
}

TEST_CASE("an invalid shape is reported with line and key") {
    struct Row {
        const char *text, *problem;
    };
    for (const Row& row : {
             Row{"{ box = [[0,0,0],[1,0,1]] }", "r.toml:1: geometry.box: the second corner must be above"},
             Row{"{ box = [[0,0,0]] }", "needs two corners"},
             Row{"{ sphere = { center = [0,0,0], radius = 0 } }", "geometry.sphere.radius: must be above zero"},
             Row{"{ sphere = { center = [0,0,0], radius = 1, colour = 2 } }", "colour"},
             Row{"{ cylinder = { from = [0,0,0], to = [0,0,0], radius = 1 } }", "is the same point as \"from\""},
             Row{"{ cylinder = { from = [0,0,0], to = [0,0,1], radius = -1 } }", "must be above zero"},
             Row{"{ prism = [[0,0],[1,0]], from = 0, to = 1 }", "at least three corners"},
             Row{"{ prism = [[0,0],[1,0],[1]], from = 0, to = 1 }", "at least three corners"},
             Row{"{ prism = [[0,0],[1,0],[0,1]], from = 1, to = 1 }", "geometry.to: must be above \"from\""},
             Row{"{ prism = [[0,0],[1,0],[0,1]], plane = \"zx\", from = 0, to = 1 }", "geometry.plane"},
             Row{"{ prism = [[0,0],[2,2],[2,0],[0,2]], from = 0, to = 1 }",
                 "crosses or touches itself: edge 1 and edge 3"},
             Row{"{ prism = [[0,0],[4,0],[4,4],[2,0],[0,4]], from = 0, to = 1 }", "crosses or touches itself"},
             Row{"{ prism = [[0,0],[1,0],[1,0],[0,1]], from = 0, to = 1 }", "corner 2 is repeated"},
             Row{"{ prism = [[0,0],[1,0],[0,1],[0,0]], from = 0, to = 1 }", "corner 4 is repeated"},
             Row{"{ prism = [[0,0],[1,0],[2,0]], from = 0, to = 1 }", "turns back on itself"},
             Row{"{ union = [] }", "geometry.union: needs a list of shapes"},
             Row{"{ union = [{ sphere = { center = [0,0,0], radius = -1 } }] }", "geometry.union[0].sphere.radius"},
             Row{"{ translate = [1,0,0] }", "\"of\" is missing"},
             Row{"{ rotate = 90, axis = [0,0,0], of = { box = [[0,0,0],[1,1,1]] } }",
                 "geometry.axis: must not be zero"},
             Row{"{ repeat = 0, step = [1,0,0], of = { box = [[0,0,0],[1,1,1]] } }", "1 to 1000 are possible"},
             Row{"{ repeat = 1001, step = [1,0,0], of = { box = [[0,0,0],[1,1,1]] } }", "1 to 1000 are possible"},
             Row{"{ bx = [[0,0,0],[1,1,1]] }", "did you mean \"box\"?"},
             Row{"{ box = [[0,0,0],[1,1,1]], sphere = { center = [0,0,0], radius = 1 } }", "two shapes at once"},
             Row{"{ box = [[0,0,0],[1,1,1e300]] }", "reaches beyond 1e+09"},
             Row{"3", "a shape is a table"},
         }) {
        CAPTURE(row.text);
        Solid solid;
        const std::string problem = read(row.text, solid);
        CAPTURE(problem);
        CHECK(problem.find(row.problem) != std::string::npos);
        CHECK(solid != nullptr);
    }
}

TEST_CASE("a name that is missing suggests the nearest") {
    Solid solid;
    CHECK(read("{ use = \"cub\" }", solid, "[shape.cube]\nbox = [[0,0,0],[1,1,1]]\n").find("did you mean \"cube\"?") !=
          std::string::npos);
}

TEST_CASE("unusual but valid outlines are read") {
    Solid solid;
    CHECK(read("{ prism = [[0,0],[1,0],[2,0],[2,1],[0,1]], from = 0, to = 1 }", solid).empty());  // corner on an edge
    CHECK(read("{ prism = [[0,0],[0,1],[1,1],[1,0]], from = 0, to = 1 }", solid).empty());        // clockwise
    CHECK(read("{ prism = [[0,0],[4,0],[4,4],[2,1],[0,4]], from = 0, to = 1 }", solid).empty());  // not convex
}

TEST_CASE("copies of copies of copies are refused before they are made, if there are too many") {
    Solid solid;
    const std::string thousand = "{ repeat = 1000, step = [2,0,0], of = ";
    CHECK(read(thousand + "{ box = [[0,0,0],[1,1,1]] } }", solid).empty());
    CHECK(read(thousand + thousand + thousand + "{ box = [[0,0,0],[1,1,1]] } } } }", solid)
              .find("repeats come to 1000000000 shapes") != std::string::npos);
}
