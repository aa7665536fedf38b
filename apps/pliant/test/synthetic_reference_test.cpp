// 3MF files of two to eight materials, from reading to the order of vats, compared with the values in the README of the
// reference data: layers, pixels of every material, overlap, swaps. Layers of 50 um, pixels of 50 um.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "base/core/near.hpp"
#include "geometry/threemf/read_3mf.hpp"
#include "printing/plan/order.hpp"
#include "printing/slice/place.hpp"
#include "printing/slice/slicer.hpp"

using namespace pliant;

namespace {

struct Outcome {
    std::vector<std::vector<long>> pixels;  ///< per layer and material: those of full light
    long grey = 0, shared = 0;
    std::vector<plan::VatList> vats;  ///< per layer: one for each material that prints
    slice::Summary summary;

    [[nodiscard]] int swaps(plan::OrderRule rule) const { return plan::count_swaps(plan::order_vats(vats, rule)); }
};

std::vector<slice::Body> bodies_of(const std::string& name) {
    const auto file =
        threemf::read_3mf(std::filesystem::path(std::getenv("PLIANT_REFERENCE_DATA")) / "3mf/synthetic" / name);
    REQUIRE_MESSAGE(file.has_value(), (file ? "" : file.error().message));
    std::vector<slice::Body> bodies;
    for (const threemf::Body& body : file->bodies)
        bodies.push_back({body.material, mesh::scaled(body.mesh_mm, 1000), body.name});
    return bodies;
}

void add_layer(const slice::SlicedLayer& layer, std::size_t materials, Outcome& outcome) {
    outcome.pixels.emplace_back(materials, 0);
    outcome.vats.emplace_back();
    for (const slice::MaterialImage& m : layer.images) {
        outcome.vats.back().push_back(m.material);
        for (int row = m.image.first_row(); row < m.image.end_row(); ++row) {
            for (const slice::Run& run : m.image.row(row)) {
                const int width = run.end - run.begin;
                (run.value == 255 ? outcome.pixels.back()[static_cast<std::size_t>(m.material)] : outcome.grey) +=
                    width;
                for (const slice::MaterialImage& other : layer.images) {
                    for (int c = run.begin; c < run.end && other.material > m.material; ++c)
                        outcome.shared += other.image.at(row, c) > 0;
                }
            }
        }
    }
}

Outcome slice_file(const std::string& name) {
    std::vector<slice::Body> bodies = bodies_of(name);
    const slice::Settings settings{{512, 512, 50}, 50, {}};
    REQUIRE(slice::place_on_platform(bodies, settings.raster).has_value());
    const auto slicer = slice::Slicer::prepare(bodies, settings);
    REQUIRE_MESSAGE(slicer.has_value(), (slicer ? "" : slicer.error().message));
    Outcome outcome;
    slice::Tally tally(*slicer);
    for (int k = 0; k < slicer->layer_count(); ++k) {
        const slice::SlicedLayer layer = slicer->layer(k);
        tally.add(k, layer);
        add_layer(layer, slicer->materials().size(), outcome);
    }
    outcome.summary = tally.summary();
    CHECK(outcome.grey == 0);
    CHECK(outcome.shared == 0);
    return outcome;
}

void check_all_layers(const Outcome& outcome, std::size_t layers, const std::vector<long>& pixels) {
    CHECK(outcome.pixels == std::vector<std::vector<long>>(layers, pixels));
}

}  // namespace

TEST_CASE("two halves: every pixel of 20 x 10 mm is in exactly one image") {
    const Outcome o = slice_file("two_halves.3mf");
    check_all_layers(o, 200, {40000, 40000});
    CHECK(o.summary.warnings.empty());
    CHECK(o.swaps(plan::OrderRule::naive) == 399);
    CHECK(o.swaps(plan::OrderRule::fewest_swaps) == 200);
    CHECK(plan::fewest_swaps(o.vats) == 200);
}

TEST_CASE("overlapping cubes: the overlap of 500 mm^3 is reported and given to one material") {
    const Outcome o = slice_file("overlap_cubes.3mf");
    check_all_layers(o, 200, {20000, 40000});
    CHECK(o.summary.overlap_mm3 == near(500, {.relative = 1e-12}));
}

TEST_CASE("a gap of 10 um leaves no dark line and is reported") {
    std::vector<slice::Body> bodies = bodies_of("gap_10um.3mf");
    const slice::Settings settings{{512, 512, 50}, 50, {}};
    REQUIRE(slice::place_on_platform(bodies, settings.raster).has_value());
    const auto slicer = slice::Slicer::prepare(bodies, settings);
    REQUIRE(slicer.has_value());
    CHECK(slicer->layer_count() == 200);
    const slice::SlicedLayer layer = slicer->layer(100);
    REQUIRE(layer.images.size() == 2);
    CHECK(layer.closed_gap_pixels == 200);
    for (int row = layer.images[0].image.first_row(); row < layer.images[0].image.end_row(); ++row) {
        const slice::Run left = layer.images[0].image.row(row).back(), right = layer.images[1].image.row(row).front();
        CHECK(left.end == right.begin);
        CHECK((left.value == 255 && right.value == 255));
    }
}

TEST_CASE("four slabs, ten bands, eight materials: layers, pixels and swaps") {
    const Outcome slabs = slice_file("stack4.3mf");
    REQUIRE(slabs.pixels.size() == 160);
    for (std::size_t k = 0; k < 160; ++k) {
        for (std::size_t m = 0; m < 4; ++m) CHECK(slabs.pixels[k][m] == (m == k / 40 ? 160000 : 0));
    }
    CHECK(plan::fewest_swaps(slabs.vats) == 3);
    const Outcome bands = slice_file("alternating_bands.3mf");
    REQUIRE(bands.pixels.size() == 200);
    for (std::size_t k = 0; k < 200; ++k) CHECK(bands.pixels[k][k / 20 % 2] == 160000);
    CHECK(plan::fewest_swaps(bands.vats) == 9);
    const Outcome checker = slice_file("checker8.3mf");
    check_all_layers(checker, 200, std::vector<long>(8, 20000));
    CHECK(checker.swaps(plan::OrderRule::naive) == 1599);
    CHECK(checker.swaps(plan::OrderRule::fewest_swaps) == 1400);
}
