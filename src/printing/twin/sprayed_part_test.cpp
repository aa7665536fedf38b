#include "printing/twin/sprayed_part.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::twin;

namespace {

/// The tower with pixels of 1 mm and one vat in use.
machine::Printer tower() {
    auto printer = machine::load_printer("examples/printers/tower.toml").value();
    printer.projector.width_px = 60;
    printer.projector.height_px = 60;
    printer.projector.pixel_um = 1000;
    return printer;
}

/// An image that is white where `solid` is true; x and y in pixels from the centre.
template <class Solid>
job::Image picture(Solid solid) {
    job::Image image{60, 60, std::vector<std::uint8_t>(3600)};
    for (int i = 0; i < 3600; ++i)
        image.pixels[static_cast<std::size_t>(i)] = solid(i % 60 - 29.5, i / 60 - 29.5) ? 255 : 0;
    return image;
}

constexpr double light_s = 1e4;

}  // namespace

TEST_CASE("surfaces hidden from the jets stay wet: a tube of 4 mm is cleaned less than a plate") {
    const machine::Printer printer = tower();
    const auto cleaned = [&](const job::Image& image) {
        Cure cure(printer);
        for (int layer = 1; layer <= 60; ++layer) cure.expose(image, 0, light_s, 500 * layer);
        cure.finish();
        REQUIRE(cure.layers().size() == 60);
        return SprayedPart(printer).removed(cure, 15).value();
    };
    const double block = cleaned(picture([](double x, double y) { return std::max(std::abs(x), std::abs(y)) < 8; }));
    const double tube = cleaned(picture([](double x, double y) {
        const double r = std::max(std::abs(x), std::abs(y));
        return r < 8 && r > 2;
    }));
    CHECK(block > 0.95);
    CHECK(tube < block - 0.05);
}

TEST_CASE("the share follows the growing part; before the first layer, or without sprinklers, there is none") {
    machine::Printer printer = tower();
    const job::Image image = picture([](double x, double y) { return std::hypot(x, y) < 20; });
    Cure cure(printer);
    SprayedPart part(printer);
    CHECK_FALSE(part.removed(cure, 15));
    for (int layer = 1; layer <= 2; ++layer) cure.expose(image, 0, light_s, 500 * layer);
    const double flat = part.removed(cure, 15).value();
    CHECK(part.removed(cure, 1).value() < flat);
    CHECK(part.removed(cure, 0).value() == 0);
    for (int layer = 3; layer <= 40; ++layer) cure.expose(image, 0, light_s, 500 * layer);
    SprayedPart anew(printer);
    CHECK(part.removed(cure, 15).value() == anew.removed(cure, 15).value());
    part.clear();
    CHECK_FALSE(part.removed(Cure(printer), 15));
    machine::Printer blind = printer;
    blind.sprinklers.clear();
    CHECK_FALSE(SprayedPart(blind).removed(cure, 15));
}

TEST_CASE("the part's lower end is the larger of this layer and the one before") {
    const machine::Printer printer = tower();
    Cure cure(printer);
    const job::Image left = picture([](double x, double y) { return x < 0 && std::abs(x) < 10 && std::abs(y) < 10; });
    const job::Image right = picture([](double x, double y) { return x > 0 && std::abs(x) < 10 && std::abs(y) < 10; });
    cure.expose(left, 0, light_s, 500);
    CHECK(cure.section_mm2() == near(200, {.relative = 1e-12}));
    cure.expose(right, 1, light_s, 500);
    CHECK(cure.section_mm2() == near(400, {.relative = 1e-12}));
    cure.expose(right, 1, light_s, 1000);
    CHECK(cure.section_mm2() == near(400, {.relative = 1e-12}));
    cure.expose(left, 0, light_s, 1500);
    CHECK(cure.section_mm2() == near(200, {.relative = 1e-12}));
}
