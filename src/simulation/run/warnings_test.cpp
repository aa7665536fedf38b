// Warnings about unreliable results: surfaces that intersect, steps accepted at a looser tolerance.
#include "simulation/run/warnings.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/core/near.hpp"
#include "simulation/run/live.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using testing::mm;
using testing::solve;

namespace {

/// A fork along x: two prongs of 2 x 2 mm, 2 mm apart, from 4 to 16 mm. The end of the upper one is pushed down by
/// `push_m`; nothing pushes the lower one.
Description fork(double push_m, int order = 1) {
    const auto prong = [](Vec3 c) { return c.x < 4 * mm || c.z < 2 * mm || c.z > 4 * mm ? 0 : 1; };
    mesh::TetMesh whole = reference::kuhn_box({16 * mm, 2 * mm, 6 * mm}, 8, 1, 6, prong);
    whole.region_names = {"fork", "air"};
    if (order == 2) whole = mesh::to_quadratic(whole);
    Description d;
    d.mesh = mesh::extract_regions(whole, {true, false}).mesh;
    d.materials = {{"rubber", material::neo_hookean(1e6, 0.3), 1000}};
    d.material_of_region = {0};
    const auto end = [](Vec3 p) { return p.x > 15.9 * mm && p.z > 3.9 * mm; };
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}},
                  {"push", reference::nodes_where(d.mesh, end), {0, 0, -push_m}}};
    return d;
}

void add_contact(Description& d) {
    d.contact = ContactRules{contact::robot_surface(d.mesh), {.distance_m = 0.05 * mm, .stiffness_Pa = 1e5}, {}};
}

std::size_t mentions(const std::vector<std::string>& warnings, const std::string& text) {
    return static_cast<std::size_t>(std::count_if(
        warnings.begin(), warnings.end(), [&](const std::string& w) { return w.find(text) != std::string::npos; }));
}

}  // namespace

TEST_CASE("without contact the first step with crossing surfaces is named, with the place") {
    // Ten steps of 0.35 mm. The base bends, so that the lower prong's end is at 1.82 mm where the upper one's is at
    // 1.9 after six of them, and at 1.77 where it is at 1.55 after seven.
    for (const int order : {1, 2}) {
        CAPTURE(order);
        const Trajectory result = solve(fork(3.5 * mm, order), {.steps = 10});
        REQUIRE_MESSAGE(result.converged, result.message);
        for (int k = 0; k <= 6; ++k) CHECK_FALSE(result.steps[static_cast<std::size_t>(k)].crossing_m.has_value());
        for (int k = 7; k <= 10; ++k) {
            const auto& place = result.steps[static_cast<std::size_t>(k)].crossing_m;
            CAPTURE(k);
            REQUIRE(place);
            CHECK(place->x > 8 * mm);  // in the outer half, on top of the lower prong
            CHECK(place->z > 1 * mm);
            CHECK(place->z < 1.9 * mm);
        }
        REQUIRE(result.warnings.size() == 1);
        CHECK(mentions(result.warnings, "from step 7 on, the robot passes through itself near (1") == 1);
        CHECK(warnings_of(result.steps[6]).empty());
        CHECK(mentions(warnings_of(result.steps[7]), "passes through itself") == 1);
    }
}

TEST_CASE("with contact nothing crosses, the lower prong bends, and there is no warning") {
    Description d = fork(3.5 * mm);
    add_contact(d);
    const Trajectory result = solve(d, {.steps = 10});
    REQUIRE_MESSAGE(result.converged, result.message);
    CHECK(result.warnings.empty());
    CHECK(result.steps[5].self_contact_N == 0);
    CHECK(result.steps.back().self_contact_N > 0);
    // The lower prong adds to what the upper one resists.
    const Trajectory free = solve(fork(3.5 * mm), {.steps = 10});
    CHECK(-result.steps.back().supports[1].force_N.z > -1.03 * free.steps.back().supports[1].force_N.z);
}

TEST_CASE("contact does not change a bit of a motion in which nothing touches") {
    Description with = fork(1.5 * mm, 2);
    add_contact(with);
    const Trajectory plain = solve(fork(1.5 * mm, 2), {.steps = 4}), touching = solve(with, {.steps = 4});
    REQUIRE(plain.converged);
    REQUIRE(touching.converged);
    for (std::size_t k = 0; k < plain.steps.size(); ++k) {
        CHECK(plain.steps[k].positions == touching.steps[k].positions);
        CHECK(plain.steps[k].energy_J == touching.steps[k].energy_J);
        CHECK(plain.steps[k].iterations == touching.steps[k].iterations);
    }
}

TEST_CASE("contact on demand changes no bit before the robot meets itself, and holds it apart afterwards") {
    Description waits = fork(3.5 * mm), always = fork(3.5 * mm);
    add_contact(waits);
    add_contact(always);
    waits.contact->self_when_met = true;
    const Trajectory plain = solve(fork(3.5 * mm), {.steps = 10}), found = solve(waits, {.steps = 10});
    const Trajectory touching = solve(always, {.steps = 10});
    REQUIRE_MESSAGE(found.converged, found.message);
    CHECK(found.warnings.empty());
    for (std::size_t k = 0; k <= 10; ++k) {
        CHECK(found.steps[k].met == (k >= 7));  // where the surfaces would have crossed
        CHECK((found.steps[k].self_contact_N > 0) == (k >= 7));
        if (k < 7) CHECK(found.steps[k].positions == plain.steps[k].positions);
    }
    const auto push = [](const Trajectory& t) { return t.steps.back().supports[1].force_N.z; };
    CHECK(push(found) / push(touching) == near(1, {.relative = 1e-6}));
}

TEST_CASE("contact on demand acts in interactive control, and ends when the robot is put to rest") {
    Description d = fork(3.5 * mm);
    add_contact(d);
    d.contact->self_when_met = true;
    const auto model = Model::create(d);
    REQUIRE(model);
    Live live(*model, {.steps = 10});
    const Progress silent;
    const auto follow = [&](double time) {
        for (int piece = 0; piece < 400 && !live.advance(live.target_at(time), silent).arrived; ++piece) {
        }
    };
    follow(1);
    CHECK(live.describe().met);
    CHECK(live.describe().self_contact_N > 0);
    CHECK(live.warnings(live.describe()).empty());
    live.return_to_rest();
    CHECK_FALSE(live.describe().met);
}

TEST_CASE("bodies that cross at rest get no contact on demand") {
    Description d = fork(1 * mm);
    for (Vec3& p : d.mesh.points)
        if (p.x > 13 * mm && p.z < 2.1 * mm) p += {0, 0.2 * mm, p.x - 13 * mm};
    add_contact(d);
    d.contact->self_when_met = true;
    const Trajectory result = solve(d, {.steps = 2});
    REQUIRE(result.converged);
    CHECK(mentions(result.warnings, "already at rest") == 1);
    CHECK_FALSE(result.steps.back().met);
}

TEST_CASE("interactive control warns of a state with crossing surfaces, and not after going back") {
    const auto model = Model::create(fork(3.5 * mm));
    REQUIRE(model);
    Live live(*model, {.steps = 10});
    const Progress silent;
    const auto follow = [&](double time) {
        for (int piece = 0; piece < 200 && !live.advance(live.target_at(time), silent).arrived; ++piece) {
        }
    };
    follow(1);
    CHECK(mentions(warnings_of(live.describe()), "passes through itself") == 1);
    follow(0.4);
    CHECK(warnings_of(live.describe()).empty());
}

TEST_CASE("bodies that overlap at rest give a warning") {
    Description d = fork(1 * mm);
    // The lower prong's end stands through the upper prong from the beginning.
    for (Vec3& p : d.mesh.points)
        if (p.x > 13 * mm && p.z < 2.1 * mm) p += {0, 0.2 * mm, p.x - 13 * mm};
    const Trajectory result = solve(d, {.steps = 2});
    CHECK(mentions(result.warnings, "already at rest") == 1);
    add_contact(d);
    const auto asked = Model::create(d);
    REQUIRE(asked);
    CHECK(asked->contact(false) != nullptr);
}

TEST_CASE("steps accepted above the tolerance are counted, and the worst one is named") {
    Trajectory t;
    t.steps.resize(5);
    for (int k = 0; k < 5; ++k) t.steps[static_cast<std::size_t>(k)].index = k;
    add_warnings(t);
    CHECK(t.warnings.empty());
    for (const std::size_t k : {2u, 3u}) {
        t.steps[k].converged = false;
        t.steps[k].residual = k == 2 ? 5e-4 : 3e-4;
        t.steps[k].reason = k == 2 ? "this" : "that";
    }
    add_warnings(t);
    REQUIRE(t.warnings.size() == 1);
    CHECK(t.warnings[0] ==
          "2 of 4 steps, the first of them step 2, were accepted above the tolerance. The worst is step "
          "2: this");
}
