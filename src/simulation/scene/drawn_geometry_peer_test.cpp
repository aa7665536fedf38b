// Robots whose mesh Pliant made from a drawing, with a cavity that a point names and with notches, against CalculiX on
// the same mesh. A cavity that a cap closes has a wall beside the mesh, for which a deck has no counterpart.
#include <doctest/doctest.h>

#include <cmath>

#include "robot/file/robot_file.hpp"
#include "simulation/peers/calculix.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using namespace pliant::robot;
using namespace pliant::robot::testing;

namespace {

const std::string drawn_head = R"(name = "drawn"
length_unit = "mm"
[material.soft]
youngs_modulus = "1 MPa"
poisson_ratio = 0.4
[mesh]
size = "4 mm"
order = 2
[[fixed]]
name = "wall"
box = [[0, 0, 0], [0, 12, 12]]
[program]
steps = 4
tolerance = 1e-7
)";

std::string drawn_body(const std::string& geometry) {
    return "[[body]]\nname = \"it\"\nmaterial = \"soft\"\ngeometry = " + geometry + "\n";
}

/// The largest distance between our nodes and theirs, as a share of the largest displacement.
void check_same(const std::string& text, double allowed) {
    const Built built = build(parse_robot(text, "drawn.toml"));
    const sim::Description& d = built.model.description();
    const sim::Step last = run_to_the_end(built).steps.back();
    const auto peer = sim::calculix::solve(d);
    REQUIRE_MESSAGE(peer, (peer ? "" : peer.error().message));
    double apart = 0, largest = 0;
    for (std::size_t n = 0; n < d.mesh.points.size(); ++n) {
        const Vec3 u = last.positions[n] - d.mesh.points[n];
        apart = std::max(apart, norm(u - peer->displacement_m[n]));
        largest = std::max(largest, norm(u));
    }
    CHECK(largest > 0.5e-3);
    MESSAGE("nodes apart by at most " << apart / largest << " of the largest displacement of " << largest << " m");
    CHECK(apart < allowed * largest);
}

/// As in simulation/peers/calculix_peer_test.cpp: seven digits are printed; pressures on curved faces are integrated
/// differently.
constexpr double same = 1e-5, same_chamber = 1e-3;

}  // namespace

TEST_CASE("a closed cavity named by a point inflates the same as in CalculiX") {
    check_same(
        drawn_head +
            drawn_body("{ difference = [{ box = [[0, 0, 0], [40, 12, 12]] }, { box = [[6, 3, 3], [36, 9, 10]] }] }") +
            "[[chamber]]\nname = \"air\"\ninside = [20, 6, 6]\ntarget = { pressure = \"50 kPa\" }\n",
        same_chamber);
}

TEST_CASE("a notched bar bends the same as in CalculiX under a cable across its notches") {
    const std::string notches =
        "{ repeat = 3, step = [10, 0, 0], of = { prism = [[9.8, 6], [10.2, 6], [12, 12], [8, 12]], plane = \"xz\", "
        "from = "
        "0, to = 12 } }";
    check_same(drawn_head + drawn_body("{ difference = [{ box = [[0, 0, 0], [40, 12, 12]] }, " + notches + "] }") +
                   "[[cable]]\nname = \"flexor\"\npoints = [[38, 6, 10], [2, 6, 10]]\neyelet_radius = \"0 mm\"\n"
                   "target = { tension = \"1.5 N\" }\n"
                   // The flanks of the notches would meet, and CalculiX's deck has no contact.
                   "[contact]\nself = false\n",
               same);
}
