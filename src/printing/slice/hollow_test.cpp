#include "printing/slice/hollow.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/core/near.hpp"
#include "printing/slice/distance_field.hpp"
#include "printing/slice/inspect.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

const Settings hollow_slicing{{240, 200, 100}, 100, {}};  // 24 x 20 mm

struct HollowOutcome {
    double volume_mm3 = 0;
    Findings findings;
    Hollowing hollowing;
};

HollowOutcome hollowed(const std::vector<Body>& part, const HollowSettings& wanted,
                       const Settings& settings = hollow_slicing) {
    Progress progress;
    auto made = hollow_out(part, settings, wanted, progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    Settings with = settings;
    with.removed = made->removed;
    const auto slicer = Slicer::prepare(part, with);
    REQUIRE(slicer.has_value());
    HollowOutcome outcome{0, {}, std::move(*made)};
    Inspector inspector(slicer->layers());
    for (int k = 0; k < slicer->layer_count(); ++k) {
        const SlicedLayer layer = slicer->layer(k);
        for (const MaterialImage& m : layer.images)
            outcome.volume_mm3 +=
                static_cast<double>(m.value_sum) / 255 * 0.01 * slicer->layers().thickness_um(k) / 1000;
        inspector.add(shape_of(layer, hollow_slicing.raster.width_px));
    }
    outcome.findings = inspector.finish();
    return outcome;
}

const std::vector<Body> block{{"soft", box({-8000, -6000, 0}, {8000, 6000, 10000}), ""}};

}  // namespace

TEST_CASE("distances agree with an exhaustive search") {
    const CellGrid grid{13, 9, 7};
    std::vector<std::uint8_t> solid(grid.size(), 1);
    for (const auto& [x, y, z] : {std::array{3, 2, 1}, std::array{9, 7, 5}, std::array{6, 4, 3}})
        solid[grid.at(x, y, z)] = 0;
    const double height = 1.5;
    const std::vector<float> found = squared_distances(grid, solid, height);
    for (int z = 0; z < grid.nz; ++z) {
        for (int y = 0; y < grid.ny; ++y) {
            for (int x = 0; x < grid.nx; ++x) {
                double least = 1e30;
                for (int k = -1; k <= grid.nz; ++k) {
                    for (int j = -1; j <= grid.ny; ++j) {
                        for (int i = -1; i <= grid.nx; ++i) {
                            if (grid.has(i, j, k) && solid[grid.at(i, j, k)] != 0) continue;
                            least = std::min(least,
                                             std::pow(i - x, 2) + std::pow(j - y, 2) + std::pow(height * (k - z), 2));
                        }
                    }
                }
                CHECK(found[grid.at(x, y, z)] == near(least, {.relative = 1e-12}));
            }
        }
    }
}

TEST_CASE("a block becomes a closed box whose walls have at least the given thickness") {
    const HollowOutcome o = hollowed(block, {2000, 0});
    CHECK(o.hollowing.cavities == 1);
    REQUIRE(o.findings.cavities.size() == 1);
    const Cavity& cavity = o.findings.cavities[0];
    CHECK(cavity.end == Cavity::End::closed);
    CHECK(cavity.first_layer >= 20);
    CHECK(cavity.last_layer <= 79);
    const double most = 12 * 8 * 6, least = 11 * 7 * 5;  // walls of 2 mm, and of 2.5
    CHECK(16 * 12 * 10 - o.volume_mm3 <= most * (1 + 1e-9));
    CHECK(16 * 12 * 10 - o.volume_mm3 >= least);
    CHECK(16 * 12 * 10 - o.volume_mm3 == near(o.hollowing.volume_mm3, {.relative = 1e-9}));
}

TEST_CASE("floors and ceilings have the given thickness, too, where layers are thick") {
    for (const int layer_um : {100, 200, 250, 400}) {
        for (const double wall_um : {500.0, 600.0, 1000.0}) {
            CAPTURE(layer_um);
            CAPTURE(wall_um);
            Settings settings = hollow_slicing;
            settings.layer_um = layer_um;
            const HollowOutcome o = hollowed(block, {wall_um, 0}, settings);
            REQUIRE(o.findings.cavities.size() == 1);
            const Cavity& cavity = o.findings.cavities[0];
            const int floor_um = cavity.first_layer * layer_um, ceiling_um = 10000 - (cavity.last_layer + 1) * layer_um;
            CHECK(floor_um >= wall_um);
            CHECK(floor_um < wall_um + layer_um);
            CHECK(ceiling_um >= wall_um);
            CHECK(ceiling_um < wall_um + 2 * layer_um);
        }
    }
}

TEST_CASE("a part whose layers differ in thickness is hollowed, and its walls are thick enough") {
    Settings settings = hollow_slicing;
    for (int top_um = 0; top_um < 10000;) {
        top_um += top_um < 2000 ? 100 : top_um < 6000 ? 330 : 170;
        settings.tops_um.push_back(top_um);
    }
    const HollowOutcome o = hollowed(block, {1000, 0}, settings);
    REQUIRE(o.findings.cavities.size() == 1);
    const Cavity& cavity = o.findings.cavities[0];
    CHECK(cavity.end == Cavity::End::closed);
    const Layers layers(settings.tops_um);
    CHECK(layers.bottom_um(cavity.first_layer) >= 1000);
    CHECK(layers.bottom_um(cavity.first_layer) <= 1700);
    CHECK(layers.top_um(cavity.last_layer) <= 9000);
    CHECK(layers.top_um(cavity.last_layer) >= 8000);
    CHECK(o.hollowing.volume_mm3 <= 14 * 10 * 8 * (1 + 1e-9));
    CHECK(o.hollowing.volume_mm3 >= 14 * 10 * 6.5);
}

TEST_CASE("drains open the box: no closed cavity is left, and the holes have their cylinders' size") {
    const HollowOutcome closed = hollowed(block, {2000, 0}), open = hollowed(block, {2000, 1500});
    CHECK(open.hollowing.drains == 2);
    for (const Cavity& c : open.findings.cavities) CHECK(c.end != Cavity::End::closed);
    const double wall = 2, hole = 3.14159 * 0.75 * 0.75 * wall;
    const double drilled = closed.volume_mm3 - open.volume_mm3;
    CHECK(drilled > 2 * hole * 0.9);
    CHECK(drilled < 2 * hole * 1.3);
}

TEST_CASE("drains lead out of the part, not into a void inside of it") {
    std::vector<Body> part = block;
    part[0].air_um.push_back(box({-1000, -4900, 1100}, {1000, 4900, 8900}));
    const HollowOutcome o = hollowed(part, {1000, 700});
    CHECK(o.hollowing.cavities == 2);
    CHECK(o.hollowing.drains == 4);
    CHECK(o.hollowing.warnings.empty());
    int closed = 0;
    for (const Cavity& c : o.findings.cavities) {
        if (c.end != Cavity::End::closed) continue;
        ++closed;
        CHECK(c.voxels == 20 * 98 * 78);
    }
    CHECK(closed == 1);
}

TEST_CASE("drains end at the face of the part, not in what stands beside it") {
    std::vector<Body> part{{"soft", box({-5000, -5000, 0}, {5000, 5000, 10000}), ""}};
    for (const double side : {-1.0, 1.0}) {
        part.push_back({"stiff", box({side * 5900 - 500, -5000, 0}, {side * 5900 + 500, 5000, 10000}), ""});
        part.push_back({"stiff", box({-5000, side * 5900 - 500, 0}, {5000, side * 5900 + 500, 10000}), ""});
    }
    Progress progress;
    Settings settings = hollow_slicing;
    const auto made = hollow_out(part, settings, {2000, 1500}, progress);
    REQUIRE(made.has_value());
    CHECK(made->drains == 2);
    settings.removed = made->removed;
    const auto slicer = Slicer::prepare(part, settings);
    REQUIRE(slicer.has_value());
    for (int k = 0; k < slicer->layer_count(); ++k) {
        for (const MaterialImage& m : slicer->layer(k).images) {
            if (slicer->materials()[static_cast<std::size_t>(m.material)] == "stiff")
                CHECK(m.value_sum == std::int64_t{4} * 10 * 100 * 255);
        }
    }
}

namespace {

/// Whether dark pixels lead from the corner of the image to all pixels of the set.
bool all_open(const SlicedLayer& layer, const RunSet& set) {
    const int width = set.width_px(), height = set.height_px();
    std::vector<std::uint8_t> closed(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const auto at = [&](int x, int y) -> std::uint8_t& { return closed[static_cast<std::size_t>(y) * width + x]; };
    for (const MaterialImage& m : layer.images) {
        for (int y = m.image.first_row(); y < m.image.end_row(); ++y) {
            for (const Run& run : m.image.row(y)) {
                for (int x = run.begin; x < static_cast<int>(run.end); ++x) at(x, y) = 1;
            }
        }
    }
    std::vector<std::array<int, 2>> reached{{0, 0}};
    while (!reached.empty()) {
        const auto [x, y] = reached.back();
        reached.pop_back();
        if (x < 0 || y < 0 || x >= width || y >= height || at(x, y) != 0) continue;
        at(x, y) = 2;
        for (const int step : {-1, 1}) {
            reached.push_back({x + step, y});
            reached.push_back({x, y + step});
        }
    }
    for (int y = set.first_row(); y < set.end_row(); ++y) {
        for (const PixelSpan& span : set.row(y)) {
            for (int x = span.begin; x < span.end; ++x) {
                if (at(x, y) != 2) return false;
            }
        }
    }
    return true;
}

}  // namespace

TEST_CASE("a drain through a sloping wall is open over all of its height") {
    mesh::TriMesh funnel = box({-3000, -3000, 0}, {3000, 3000, 6000});
    for (Vec3& p : funnel.points) {
        if (p.z > 0) p = {3 * p.x, 3 * p.y, p.z};
    }
    const std::vector<Body> part{{"soft", std::move(funnel), ""}};
    Progress progress;
    Settings settings = hollow_slicing;
    const auto made = hollow_out(part, settings, {1000, 1500}, progress);
    REQUIRE(made.has_value());
    settings.removed = made->removed;
    const auto slicer = Slicer::prepare(part, settings);
    REQUIRE(slicer.has_value());
    int first = 0;
    while (settings.removed->at(first).empty()) ++first;
    for (int k = first; k < first + 14; ++k) {
        CAPTURE(k);
        CHECK(all_open(slicer->layer(k), settings.removed->at(k)));
    }
}

TEST_CASE("a cavity that no way leads out of gets no drain, and a warning") {
    std::vector<Body> part{{"soft", box({-9000, -9000, 0}, {9000, 9000, 9000}), ""}};
    for (const double side : {-1.0, 1.0}) {
        part[0].air_um.push_back(box({side * 7000 - 500, -7500, 500}, {side * 7000 + 500, 7500, 8500}));
        part[0].air_um.push_back(box({-6500, side * 7000 - 500, 500}, {6500, side * 7000 + 500, 8500}));
    }
    const HollowOutcome o = hollowed(part, {1000, 1000});
    CHECK(o.hollowing.drains == 0);
    REQUIRE(o.hollowing.warnings.size() == 2);
    CHECK(o.hollowing.warnings[0].find("gets no drain at its bottom") != std::string::npos);
}

TEST_CASE("a part without any place thick enough is refused") {
    Progress progress;
    const auto made = hollow_out(block, hollow_slicing, {6000, 0}, progress);
    REQUIRE(!made.has_value());
    CHECK(made.error().message == "hollow: nothing of the part lies 6 mm deep inside of it");
    CHECK(!hollow_out(block, hollow_slicing, {0, 0}, progress).has_value());
}
