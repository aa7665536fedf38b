#include "simulation/run/free_motion.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// A block of 40 x 10 x 10 mm, named "bar", held at the nodes that `held` catches.
Description held_block(const std::function<bool(Vec3)>& held, int order = 2) {
    Description d;
    d.mesh = reference::kuhn_box({0.04, 0.01, 0.01}, 4, 2, 2, [](Vec3) { return 0; });
    d.mesh.region_names = {"bar"};
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"A", material::neo_hookean(1e5, 0.4), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, held), {}}};
    return d;
}

/// Two blocks of 10 mm cubes side by side, "left" and "right", that share the nodes at x = 10 mm which `shared` takes;
/// the left one is clamped.
Description two_blocks(const std::function<bool(Vec3)>& shared) {
    Description d = held_block([](Vec3 p) { return p.x < 1e-9; }, 1);
    d.mesh = reference::kuhn_box({0.02, 0.01, 0.01}, 4, 2, 2, [](Vec3 c) { return c.x > 0.01 ? 1 : 0; });
    d.mesh.region_names = {"left", "right"};
    std::vector<int> copy(d.mesh.points.size(), -1);
    for (std::size_t n = 0; n < copy.size(); ++n) {
        const Vec3 p = d.mesh.points[n];
        if (std::fabs(p.x - 0.01) > 1e-9 || shared(p)) continue;
        copy[n] = static_cast<int>(d.mesh.points.size());
        d.mesh.points.push_back(p);
    }
    for (std::size_t k = 0; k < d.mesh.nodes.size(); ++k) {
        int& node = d.mesh.nodes[k];
        if (d.mesh.region[k / 4] == 1 && copy[static_cast<std::size_t>(node)] >= 0)
            node = copy[static_cast<std::size_t>(node)];
    }
    d.material_of_region = {0, 0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    return d;
}

bool says(const std::optional<std::string>& text, std::string_view part) {
    return text && text->find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a held face leaves no free motion, nor do three held nodes that are not on a line") {
    CHECK_FALSE(free_motion(held_block([](Vec3 p) { return p.x < 1e-9; })));
    CHECK_FALSE(free_motion(held_block([](Vec3 p) { return p.x < 1e-9 && p.y + p.z < 0.0101; }, 1)));
    // Two lines that are apart, in two supports.
    Description d = held_block([](Vec3 p) { return p.x < 1e-9 && p.z < 1e-9; });
    d.supports.push_back(
        {"other", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 0.04 - 1e-9 && p.z < 1e-9; }), {}});
    CHECK_FALSE(free_motion(d));
}

TEST_CASE("a support of one node or one line leaves a free rotation, which is named") {
    const auto point = free_motion(held_block([](Vec3 p) { return norm(p - Vec3{0, 0.005, 0.01}) < 1e-9; }));
    REQUIRE(point);
    CHECK_MESSAGE(says(point, "body \"bar\" can turn freely about the point (0, 5, 10) mm"), *point);
    const auto line = free_motion(held_block([](Vec3 p) { return p.x < 1e-9 && p.z < 1e-9; }));
    REQUIRE(line);
    CHECK_MESSAGE(says(line, "body \"bar\" can turn freely about the line through (0, "), *line);
    CHECK_MESSAGE(says(line, ", 0) mm and (0, "), *line);
}

TEST_CASE("bodies that share an edge or a corner form a hinge, those that share a face do not") {
    CHECK_FALSE(free_motion(two_blocks([](Vec3) { return true; })));
    const auto edge = free_motion(two_blocks([](Vec3 p) { return p.z < 1e-9; }));
    REQUIRE(edge);
    CHECK_MESSAGE(says(edge, "body \"right\" can turn freely about the line through (10, "), *edge);
    const auto corner = free_motion(two_blocks([](Vec3 p) { return p.z < 1e-9 && p.y < 1e-9; }));
    REQUIRE(corner);
    CHECK_MESSAGE(says(corner, "body \"right\" can turn freely about the point (10, 0, 0) mm"), *corner);
    // An edge and a corner off it: together they hold.
    CHECK_FALSE(free_motion(two_blocks([](Vec3 p) { return p.z < 1e-9 || (p.z > 0.01 - 1e-9 && p.y < 1e-9); })));
}

TEST_CASE("a rigid plate over both bodies locks their hinge") {
    Description d = two_blocks([](Vec3 p) { return p.z < 1e-9; });
    d.plates = {{"splint", reference::nodes_where(d.mesh, [](Vec3 p) { return p.y < 1e-9 && p.x > 0.004; })}};
    CHECK_FALSE(free_motion(d));
}

TEST_CASE("a body joined to nothing is not called a hinge") {
    CHECK_FALSE(free_motion(two_blocks([](Vec3) { return false; })));
}

TEST_CASE("rollers hold their directions, and springs resist changes of their length") {
    const auto plane = [](const Description& d, std::size_t axis) {
        Support support{"plane", reference::nodes_where(d.mesh, [=](Vec3 p) { return p[axis] < 1e-9; }), {}};
        Vec3 direction;
        direction[axis] = 3;
        support.directions = {direction};
        return support;
    };
    Description d = held_block([](Vec3) { return true; });
    d.supports = {plane(d, 0), plane(d, 1), plane(d, 2)};
    CHECK_FALSE(free_motion(d));
    d.supports.erase(d.supports.begin());
    const auto slide = free_motion(d);
    REQUIRE(slide);
    // either sense of the line
    CHECK_MESSAGE((says(slide, "body \"bar\" can slide freely along (1, 0, 0); hold it") ||
                   says(slide, "body \"bar\" can slide freely along (-1, 0, 0); hold it")),
                  *slide);
    d.springs = {{"spring", {{{0}, {1.0}, {}}, {{}, {}, {-0.05, 0, 0}}}, 10}};
    CHECK_FALSE(free_motion(d));
    d.springs[0].points[1].fixed = {0, 0, -0.05};  // across the slide: it does not hold it
    CHECK(free_motion(d));
    d.supports = {plane(d, 2)};
    CHECK_MESSAGE(says(free_motion(d), "can move freely in 3 ways"), *free_motion(d));
}
