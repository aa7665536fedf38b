#include "printing/wash/spray.hpp"

#include <doctest/doctest.h>

#include <numbers>
#include <string>

#include "base/core/near.hpp"
#include "printing/wash/run_off.hpp"
#include "printing/wash/test_parts.hpp"

using namespace pliant;
using namespace pliant::wash;

namespace {

/// One nozzle directly below the middle of the platform, with the carriage back.
machine::Printer one_head(double cone_deg) {
    machine::Printer p = wash::test::tower();
    machine::Sprinkler head;
    head.place_mm = {0, p.carriage.back_off_um / 1000.0, 0};  // the carriage moves along y
    head.cone_rad = cone_deg * std::numbers::pi / 180;
    p.sprinklers = {head};
    return p;
}

double seen_mm2(const std::vector<Face>& faces, const std::vector<double>& rates) {
    double area = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) area += rates[f] > 0 ? faces[f].area_mm2 : 0;
    return area;
}

Cleanness cleaned(const PartCells& part, const machine::Printer& printer) {
    const std::vector<Face> faces = wet_faces(part);
    return cleanness(faces, washed_rates(part, faces, printer, strokes_of(printer)), printer.cleaning.spray_s);
}

}  // namespace

TEST_CASE("a plate over one sprinkler gets the flow given by distance and cone") {
    const machine::Printer p = one_head(60);
    const PartCells plate = wash::test::cells_of(10, 2, 0.5, [](double, double, double) { return true; });
    const std::vector<Face> faces = wet_faces(plate);
    const std::vector<double> rates = spray_rates(plate, faces, p, {});
    // 20 ml in 15 s into a cone of 60 degrees; the plate hangs 2 mm above the rim of 82.55 mm.
    const double steradians = 2 * std::numbers::pi * (1 - std::cos(std::numbers::pi / 6));
    const double distance = 82.55 + 2;
    const double expected = 20000.0 / 15 / steradians / (distance * distance);
    int middles = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const bool middle = faces[f].normal == Vec3{0, 0, -1} && std::hypot(faces[f].middle.x, faces[f].middle.y) < 0.5;
        if (!middle) continue;
        ++middles;
        CHECK(rates[f] / expected == near(1, {.relative = 1e-3}));
    }
    CHECK(middles == 4);
}

TEST_CASE("beyond the cone, behind another part and on the far side the part stays wet") {
    // 40 mm wide, 84.55 mm away: the edge is seen under 13 degrees, more than half of a cone of 20.
    const PartCells plate = wash::test::cells_of(40, 2, 0.5, [](double, double, double) { return true; });
    const std::vector<Face> faces = wet_faces(plate);
    const std::vector<double> rates = spray_rates(plate, faces, one_head(20), {});
    const double radius = 84.55 * std::tan(std::numbers::pi / 18);
    CHECK(seen_mm2(faces, rates) / (std::numbers::pi * radius * radius) == near(1, {.relative = 0.03}));
    // A stem of 10 x 10 mm with a plate at its far end: everything above the plate is shaded by it.
    const PartCells shade = wash::test::cells_of(
        40, 30, 0.5, [](double x, double y, double d) { return d > 28 || (std::abs(x) < 5 && std::abs(y) < 5); });
    const std::vector<Face> all = wet_faces(shade);
    const std::vector<double> few = spray_rates(shade, all, one_head(120), {});
    for (std::size_t f = 0; f < all.size(); ++f) {
        if (all[f].middle.z > -27) CHECK(few[f] == 0);
    }
    const Cleanness c = cleanness(all, few, 1e6);
    CHECK(c.removed / (1 - c.unseen) == near(1, {.relative = 1e-12}));
    CHECK(c.unseen > 0.5);
}

TEST_CASE("the four parts of table 4.2 have the weighed masses and the measured cleanness") {
    const machine::Printer p = wash::test::tower();
    for (const wash::test::Measured& m : wash::test::parts_of_table_4_2()) {
        const std::string name = m.name;
        CAPTURE(name);
        double cells = 0;
        for (const std::uint8_t solid : m.part.solid) cells += solid;
        const double ml = cells * m.part.cell_mm * m.part.cell_mm * m.part.high_mm / 1000;
        CHECK(ml * 1.12 / m.weight_g == near(1, {.relative = 0.06}));  // g/ml of cured resin
        const Cleanness c = cleaned(m.part, p);
        MESSAGE(name << ": " << 100 * c.removed << " %, measured " << 100 * m.removed << " %, unseen " << 100 * c.unseen
                     << " %");
        CHECK(std::abs(c.removed - m.removed) < 0.035);
    }
    // The pits' tips point up: no solution flows in there, whereas it flows along the beams of a scaffold.
    const Cleanness scaffold = cleaned(wash::test::scaffold(), p), pyramids = cleaned(wash::test::pyramids(), p);
    CHECK(scaffold.removed > pyramids.removed);
    CHECK(scaffold.unseen < pyramids.unseen);
    const std::vector<Face> faces = wet_faces(wash::test::scaffold());
    const Cleanness jets = cleanness(faces, spray_rates(wash::test::scaffold(), faces, p, strokes_of(p)), 15);
    CHECK(jets.removed < scaffold.removed - 0.1);
}

TEST_CASE("joining cells keeps the part's place, and nearly its surface") {
    const PartCells fine = wash::test::cylinder();
    const PartCells coarse = coarsened(fine, 54);
    CHECK(coarse.cell_mm == near(1, {.relative = 1e-12}));
    CHECK(coarse.x_mm == fine.x_mm);
    CHECK(coarse.height_mm() == near(fine.height_mm(), {.relative = 1e-12}));
    const auto area = [](const PartCells& part) {
        double sum = 0;
        for (const Face& face : wet_faces(part)) sum += face.area_mm2;
        return sum;
    };
    // A disc and its rim: pi r (r + 2 h).
    const double exact = std::numbers::pi * 26.5 * (26.5 + 12);
    CHECK(area(fine) == near(exact, {.relative = 0.06}));
    CHECK(area(coarse) == near(exact, {.relative = 0.12}));
}
