#include "presentation/print_report/cured_block.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "presentation/draw/colour.hpp"

using namespace pliant;
using namespace pliant::report;
using pliant::test::holds;

namespace {

constexpr int width = 40, height = 20;

/// The tower with a small projector: pixels of 0.5 mm.
machine::Printer small_tower() {
    auto printer = machine::load_printer("examples/printers/tower.toml").value();
    printer.projector.width_px = width;
    printer.projector.height_px = height;
    printer.projector.pixel_um = 500;
    printer.projector.grey.clear();
    return printer;
}

/// A block of 10 x 10 pixels: 25 mm^2.
job::Image square() {
    job::Image image{width, height, std::vector<std::uint8_t>(width * height)};
    for (int row = 5; row < 15; ++row) {
        for (int column = 10; column < 20; ++column) image.pixels[static_cast<std::size_t>(row * width + column)] = 255;
    }
    return image;
}

job::Manifest square_job() {
    job::Manifest job;
    job.name = "square";
    job.width_px = width;
    job.height_px = height;
    job.pixel_um = 500;
    job.materials = {{"soft", "semi-flex", 2.5, 0, 2.5, 2.5}};
    job.layers = {{50, 50, {{0, "a", 25}}}, {100, 50, {{0, "b", 25}}}};
    return job;
}

Result<twin::Runs> square_runs(int, int) {
    return twin::runs_of(square());
}

/// Fetches the vat of slot 1 and lights the square at every height.
CuredBlock printed(const std::vector<double>& heights_mm, const job::Manifest& job) {
    const auto printer = small_tower();
    twin::Twin twin(printer);
    const auto send = [&](const std::string& line) {
        twin.receive(line + "\n");
        twin.advance_to(twin.now() + 100);
    };
    for (const char* line : {"M84 S0", "G90", "G28 Z", "G28 X", "G28 Y", "G1 Y0.5", "G1 X355.6", "G1 Y30", "G1 X0"})
        send(line);
    for (const double z : heights_mm) {
        send(fmt::format("G1 Z{:.3f}", z));
        twin.light_on(square());
        twin.advance_to(twin.now() + 2.5);
        twin.light_off();
    }
    return cured_block(twin, job, square_runs).value();
}

double volume_mm3(const twin::CoarsePart& part, int material) {
    double sum = 0;
    for (const auto& run : part.runs()) {
        const auto& slab = part.slabs()[run.slab];
        if (run.material == material) sum += (run.end - run.begin) * 0.25 * (slab.top_um - slab.bottom_um) / 1000;
    }
    return sum;
}

}  // namespace

TEST_CASE("a block printed as drawn has no deviation, and its section says so") {
    const CuredBlock block = printed({0.05, 0.1}, square_job());
    CHECK_MESSAGE(block.report.passed, twin::report_text(block.report));
    CHECK(volume_mm3(block.asked, 0) == near(2.5, {.relative = 1e-12}));
    CHECK(volume_mm3(block.cured, 0) == near(2.5, {.relative = 1e-12}));
    CHECK(block.off.runs().empty());
    const auto png = block_picture(block, square_job(), small_tower().projector);
    REQUIRE(png);
    CHECK(png->substr(1, 3) == "PNG");
    const std::string page = block_section(block, square_job(), *png);
    CHECK(holds(page, "pill good\">as drawn"));
    CHECK(holds(page, "<td>2.500 mm³</td>"));
    CHECK_FALSE(holds(page, "First deviation"));
    CHECK(holds(page, hex(palette(0))));
    job::Manifest coloured = square_job();
    coloured.materials[0].colour = "#12ab34";
    CHECK(block_picture(block, coloured, small_tower().projector).value() != *png);
    CHECK(holds(block_section(block, coloured, *png), "background:#12ab34"));
}

TEST_CASE("a layer without exposure is missing in the picture, and the text names it") {
    const CuredBlock block = printed({0.05}, square_job());
    CHECK_FALSE(block.report.passed);
    CHECK(volume_mm3(block.cured, 0) == near(1.25, {.relative = 1e-12}));
    CHECK(volume_mm3(block.off, 0) == 0);
    CHECK(volume_mm3(block.off, 1) == near(1.25, {.relative = 1e-12}));
    const std::string page =
        block_section(block, square_job(), block_picture(block, square_job(), small_tower().projector).value());
    CHECK(holds(page, "First deviation: layer 2: nothing cured at 100 um"));
    CHECK(holds(page, "<b>off</b>"));
}

TEST_CASE("material cured in the wrong resin is drawn as such, not as missing") {
    job::Manifest job = square_job();
    job.materials[0].resin = small_tower().vats[1].resin;  // the vat that printed holds another resin
    REQUIRE(job.materials[0].resin != small_tower().vats[0].resin);
    const CuredBlock block = printed({0.05, 0.1}, job);
    CHECK(block.report.materials[0].foreign_mm3 == near(2.5, {.relative = 1e-12}));
    CHECK(volume_mm3(block.off, 0) == near(2.5, {.relative = 1e-12}));
    CHECK(volume_mm3(block.off, 1) == 0);
    CHECK(volume_mm3(block.cured, 0) == 0);  // no material of the job is of the resin that cured
    CHECK(volume_mm3(block.cured, 1) == near(2.5, {.relative = 1e-12}));
}
