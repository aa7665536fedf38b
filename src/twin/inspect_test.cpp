#include "twin/inspect.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace pliant;
using namespace pliant::twin;

namespace {

/// The tower with a projector of 4 x 2 pixels of 1 mm.
machine::Printer small_tower() {
    auto printer = machine::load_printer("examples/printers/tower.toml").value();
    printer.projector.width_px = 4;
    printer.projector.height_px = 2;
    printer.projector.pixel_um = 1000;
    return printer;
}

const job::Image half{4, 2, {255, 255, 0, 0, 255, 255, 0, 0}};

Result<job::Image> half_image(int, int) {
    return half;
}

/// Two layers of half the plate in semi-flex: 4 mm^2 x 0.1 mm.
job::Manifest half_job() {
    job::Manifest job;
    job.name = "half";
    job.width_px = 4;
    job.height_px = 2;
    job.pixel_um = 1000;
    job.materials = {{"soft", "semi-flex", 0.4, 0, 2.5, 2.5}};
    job.layers = {{50, 50, {{0, "a", 4}}}, {100, 50, {{0, "b", 4}}}};
    return job;
}

/// Homes, fetches the vat of slot 1 and lights the image at every height.
void print(Twin& twin, const std::vector<double>& heights_mm, double seconds = 2.5, const job::Image& image = half) {
    const auto send = [&](const std::string& line) {
        twin.receive(line + "\n");
        twin.advance_to(twin.now() + 100);
    };
    for (const char* line : {"M84 S0", "G90", "G28 Z", "G28 X", "G28 Y", "G1 Y0.5", "G1 X355.6", "G1 Y30", "G1 X0"})
        send(line);
    for (const double z : heights_mm) {
        send(fmt::format("G1 Z{:.3f}", z));
        twin.light_on(image);
        twin.advance_to(twin.now() + seconds);
        twin.light_off();
    }
}

Report inspected(const std::vector<double>& heights_mm, double seconds = 2.5) {
    const auto printer = small_tower();
    Twin twin(printer);
    print(twin, heights_mm, seconds);
    return inspect(twin, half_job(), half_image).value();
}

}  // namespace

TEST_CASE("the right layers pass, with the drawn volume") {
    const Report r = inspected({0.05, 0.1});
    CHECK_MESSAGE(r.passed, report_text(r));
    CHECK(r.materials[0].cured_mm3 == doctest::Approx(0.4));
    CHECK(r.materials[0].tolerance_mm3 == doctest::Approx(0.004));
    CHECK(r.resins[0].left_ml == doctest::Approx(700 - 0.4e-3));
    CHECK(r.layers == 2);
    CHECK(report_json(r).find("\"passed\": true") != std::string::npos);
}

TEST_CASE("the part is taken off, the vat filled again: the next print begins anew") {
    const auto printer = small_tower();
    Twin twin(printer);
    print(twin, {0.05, 0.1});
    REQUIRE(inspect(twin, half_job(), half_image).value().passed);
    CHECK(twin.closed_layers().size() == 2);
    twin.take_part_off();
    CHECK(twin.closed_layers().empty());
    CHECK(twin.log().exposures == 0);
    CHECK(twin.cured().left_ml()[0] == doctest::Approx(700 - 0.4e-3));
    twin.fill_vat(1);
    twin.fill_vat(99);  // there is none
    CHECK(twin.cured().left_ml()[0] == 700);
    for (const double z : {0.05, 0.1}) {
        twin.receive(fmt::format("G1 Z50\nG1 Z{:.3f}\n", z));
        twin.advance_to(twin.now() + 100);
        twin.light_on(half);
        twin.advance_to(twin.now() + 2.5);
        twin.light_off();
    }
    const Report again = inspect(twin, half_job(), half_image).value();
    CHECK_MESSAGE(again.passed, report_text(again));
}

TEST_CASE("a missing layer, a wrong height, a short or a double light fail") {
    const Report missing = inspected({0.05});
    CHECK_FALSE(missing.passed);
    CHECK(missing.missing_layers == 1);
    CHECK(missing.materials[0].missing_mm3 == doctest::Approx(0.2));
    CHECK(missing.wrong_pixels == 4);
    const Report high = inspected({0.06, 0.1});
    CHECK_FALSE(high.passed);
    CHECK(high.stray_layers == 1);
    CHECK(high.wrong_thickness == 1);
    CHECK_FALSE(inspected({0.05, 0.1}, 1).passed);
    const Report twice = inspected({0.05, 0.05, 0.1});
    CHECK_FALSE(twice.passed);
    CHECK(twice.pixels_lit_twice == 4);
}

TEST_CASE("a volume that the images do not hold fails against the model") {
    const auto printer = small_tower();
    Twin twin(printer);
    print(twin, {0.05, 0.1});
    job::Manifest job = half_job();
    job.materials[0].model_volume_mm3 = 0.41;
    CHECK_FALSE(inspect(twin, job, half_image)->passed);
    job.materials[0].model_area_mm2 = 0.02;  // one pixel layer of 0.5 mm around it: 0.01 mm^3 more
    CHECK(inspect(twin, job, half_image)->passed);
}

TEST_CASE("another resin than the material's is foreign") {
    const auto printer = small_tower();
    Twin twin(printer);
    print(twin, {0.05, 0.1});
    job::Manifest job = half_job();
    job.materials[0].resin = "rigid-flex";
    const Report r = inspect(twin, job, half_image).value();
    CHECK_FALSE(r.passed);
    CHECK(r.materials[0].foreign_mm3 == doctest::Approx(0.4));
    CHECK(r.materials[0].missing_mm3 == 0);
}

TEST_CASE("an image that cannot be had is an error") {
    const auto printer = small_tower();
    Twin twin(printer);
    CHECK_FALSE(inspect(twin, half_job(), [](int, int) -> Result<job::Image> { return input_error("gone"); }));
}

TEST_CASE("the oracle sees through the projector's grey and mask") {
    machine::Printer printer = small_tower();
    printer.projector.grey = {0, 0.8, 1};
    // Two whole pixels and two covered by 128 / 255, to which the grey gives 204; the lower row is masked to 200.
    const job::Image shown{4, 2, {255, 204, 0, 0, 200, 160, 0, 0}};
    Options options;
    options.mask = job::Image{4, 2, {255, 255, 255, 255, 200, 200, 200, 200}};
    job::Manifest job = half_job();
    const double area_mm2 = (255 + 128 + 255 + 128) / 255.0;
    job.materials[0].model_volume_mm3 = area_mm2 / 10;
    for (job::Layer& layer : job.layers) layer.images[0].area_mm2 = area_mm2;
    const auto verdict = [&](const Options& with, const job::Image& image) {
        Twin twin(printer, with);
        print(twin, {0.05, 0.1}, 2.5, image);
        return inspect(twin, job, ImageSource([&](int, int) -> Result<job::Image> { return image; })).value();
    };
    const Report good = verdict(options, shown);
    CHECK_MESSAGE(good.passed, (good.reasons.empty() ? "" : good.reasons.front()));
    CHECK(good.materials[0].cured_mm3 == doctest::Approx(area_mm2 / 10).epsilon(0.005));
    // The same images on a projector without that mask, and images without mask on this projector.
    const Report uneven = verdict(Options{}, shown);
    CHECK(!uneven.passed);
    CHECK(uneven.reasons.at(0).find("on this projector the images hold") != std::string::npos);
    const Report bright = verdict(options, {4, 2, {255, 204, 0, 0, 255, 204, 0, 0}});
    CHECK(!bright.passed);
    CHECK(bright.log.overlit_pixels == 4);
}
