#include "printing/wash/best_spray.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "printing/wash/run_off.hpp"
#include "printing/wash/test_parts.hpp"

using namespace pliant;
using namespace pliant::wash;
using pliant::test::holds;

namespace {

PartCells disc() {
    return coarsened(wash::test::cylinder(), 54);
}

}  // namespace

TEST_CASE("the best spray reaches the printer's own cleanness with less solution") {
    machine::Printer p = wash::test::tower();
    const PartCells part = disc();
    const std::vector<Face> faces = wet_faces(part);
    const double own = cleanness(faces, washed_rates(part, faces, p, strokes_of(p)), p.cleaning.spray_s).removed;
    const Result<BestSpray> best = best_spray(part, p, 0.95);
    REQUIRE_MESSAGE(best, (best ? "" : best.error().message));
    MESSAGE(best->strokes.x_um << " um, " << best->strokes.z_um << " um, " << best->seconds << " s");
    CHECK(own > 0.95);
    CHECK(best->seconds < p.cleaning.spray_s);
    CHECK(best->solution_ml / best->seconds == near(20.0 / 15, {.relative = 1e-12}));
    CHECK(best->removed >= 0.95);
    const auto rates = washed_rates(part, faces, p, best->strokes);
    CHECK(cleanness(faces, rates, best->seconds).removed == near(best->removed, {.relative = 1e-12}));
    // The hooks, the way to them and the tower's move by one slot take 2 (3 + 15 / 15.2 + 15.2 / 50 + 101.6 / 40 + 40 /
    // 200) s, more than this disc needs.
    const double store_s = 2 * (3 + 15 / 15.2 + 15.2 / 50 + 101.6 / 40 + 40.0 / 200);
    CHECK(best->seconds == near(store_s, {.relative = 0.01}));
}

TEST_CASE("with instant moves no other strokes clean in a shorter time than the best spray") {
    machine::Printer p = wash::test::tower();
    for (machine::AxisSpec& axis : p.axes) axis.speed_mm_s = axis.acceleration_mm_s2 = 1e7;
    p.cleaning.speed_mm_s = p.hooks.speed_mm_s = 1e7;
    const PartCells block = coarsened(wash::test::pyramids(), 34);
    const std::vector<Face> sides = wet_faces(block);
    const Result<BestSpray> best = best_spray(block, p, 0.9);
    REQUIRE_MESSAGE(best, (best ? "" : best.error().message));
    const auto removed = [&](const Strokes& strokes, double seconds) {
        return cleanness(sides, washed_rates(block, sides, p, strokes), seconds).removed;
    };
    CHECK(removed(best->strokes, best->seconds) >= 0.9);
    CHECK(removed(best->strokes, best->seconds - 0.2) < 0.9);
    for (const int x_um : {1000, 8000, 30000, 60000, 100000, 150000, 300000}) {
        for (const int z_um : {0, 5000, 8000}) CHECK(removed({x_um, z_um}, best->seconds - 0.5) < 0.9);
    }
}

TEST_CASE("an unreachable goal is reported, with what is missing") {
    const machine::Printer p = wash::test::tower();
    const Result<BestSpray> scaffold = best_spray(coarsened(wash::test::scaffold(), 32), p, 0.99);
    REQUIRE_FALSE(scaffold);
    CHECK(holds(scaffold.error().message, "no oscillation cleans the part to 99.0 %: at most "));
    CHECK(holds(scaffold.error().message, "no spray reaches the rest"));
    machine::Printer dry = p;
    dry.sprinklers.clear();
    CHECK(holds(best_spray(disc(), dry, 0.9).error().message, "has no [[sprinkler]] tables"));
    dry = p;
    dry.cleaning.solvent_ml_s = 0;
    CHECK(holds(best_spray(disc(), dry, 0.9).error().message, "cleaning.solvent"));
    for (const double wanted : {0.0, 1.0, -1.0, 2.0})
        CHECK(holds(best_spray(disc(), p, wanted).error().message, "must be above 0 and below 1"));
}
