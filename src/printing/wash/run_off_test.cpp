#include "printing/wash/run_off.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "base/core/near.hpp"
#include "printing/wash/test_parts.hpp"

using namespace pliant;
using namespace pliant::wash;

namespace {

/// Flow over each face if only those for which `hit` is true get 1 mm per second.
template <class Hit>
std::vector<double> flow(const PartCells& part, const std::vector<Face>& faces, Hit hit) {
    std::vector<double> rates;
    for (const Face& face : faces) rates.push_back(hit(face) ? 1 : 0);
    return with_run_off(part, faces, rates);
}

bool is_side(const Face& face) {
    return face.axis.z == 0;
}

}  // namespace

TEST_CASE("down a wall all liquid runs to the lower edge, and none goes up") {
    // A column of 1 mm, 10 mm high; the top half millimetre of its wall is hit.
    const PartCells column = wash::test::cells_of(1, 10, 0.5, [](double, double, double) { return true; });
    const std::vector<Face> faces = wet_faces(column);
    const auto rates = flow(column, faces, [](const Face& f) { return is_side(f) && f.middle.z > -0.5; });
    double hit = 0, off = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (is_side(faces[f])) CHECK(rates[f] > 0);
        if (is_side(faces[f]) && faces[f].middle.z > -0.5) hit += faces[f].area_mm2;
        if (faces[f].axis.z < 0) off += rates[f] * faces[f].area_mm2;
    }
    CHECK(off / hit == near(1, {.relative = 1e-12}));
    const auto low = flow(column, faces, [](const Face& f) { return is_side(f) && f.middle.z < -9.5; });
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (faces[f].middle.z > -9.5) CHECK(low[f] == 0);
    }
}

TEST_CASE("from an underside liquid drips onto the ledge below, wets it and leaves over all its edges") {
    // A plate of 4 mm over one of 8 mm, held 6 mm below it by a thin stem at the edge.
    const auto solid = [](double x, double y, double d) {
        if (d < 1) return std::abs(x) < 2 && std::abs(y) < 2;
        if (d > 7) return true;
        return x > 1 && x < 2 && std::abs(y) < 0.5;
    };
    const PartCells part = wash::test::cells_of(8, 8, 0.5, solid);
    const std::vector<Face> faces = wet_faces(part);
    const auto is_under = [](const Face& f) { return f.axis.z < 0 && f.middle.z > -1.5; };
    const auto rates = flow(part, faces, is_under);
    double hit = 0, on_ledge = 0, least = 1e9, most = 0, off_below = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const double q = rates[f] * faces[f].area_mm2;
        if (is_under(faces[f])) hit += faces[f].area_mm2;
        if (faces[f].axis.z > 0) {
            on_ledge += q;
            least = std::min(least, rates[f]);
            most = std::max(most, rates[f]);
        }
        if (faces[f].axis.z < 0 && faces[f].middle.z < -7.5) off_below += q;
    }
    CHECK(on_ledge / hit == near(1, {.relative = 1e-12}));
    CHECK(most / least == near(1, {.relative = 1e-12}));
    CHECK(off_below / hit == near(1, {.relative = 1e-12}));
}

TEST_CASE("no liquid runs into a pit whose tip points up") {
    const PartCells block = wash::test::pyramids();
    const std::vector<Face> faces = wet_faces(block);
    const auto rates = flow(block, faces, [](const Face& f) {
        return is_side(f) && std::max(std::abs(f.middle.x), std::abs(f.middle.y)) > 16.9;
    });
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (std::abs(faces[f].middle.x) < 15 && std::abs(faces[f].middle.y) < 15 && faces[f].middle.z > -15)
            CHECK(rates[f] == 0);
    }
}
