#include "printing/twin/planned_cure.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::twin;

namespace {

constexpr double cure_depth_um = 120, layer_um = 50;

/// Pixels of 0.1 mm; a resin that cures 120 um in 2 s, with that depth of penetration.
machine::Printer printer_with(double penetration_um) {
    machine::Printer p;
    p.tower.slots = 2;
    p.vats = {{1, "other", 1}, {2, "soft", 1e-9}};
    p.resins = {{"soft", 2, 2, 0, 120, 0.8, penetration_um, 2 * std::exp(-cure_depth_um / penetration_um)}};
    p.projector.width_px = 4;
    p.projector.height_px = 2;
    p.projector.pixel_um = 100;
    return p;
}

/// A leg of one pixel, ten layers high, below a plate of eight pixels and thirty layers.
job::Manifest table() {
    job::Manifest job;
    job.width_px = 4;
    job.height_px = 2;
    job.pixel_um = 100;
    job.materials = {{"leg and plate", "soft", 0, 0, 2, 2}};
    for (int k = 0; k < 40; ++k) job.layers.push_back({50 * (k + 1), 50, {{0, "a", k < 10 ? 0.01 : 0.08}}});
    return job;
}

Result<Runs> table_image(int layer, int) {
    return layer < 10 ? Runs{{0, 0, 1, 255}} : Runs{{0, 0, 4, 255}, {1, 0, 4, 255}};
}

Progress quiet;

double deepest_um(double penetration_um) {
    return cure_depth_um - layer_um - penetration_um * std::log(1 - std::exp(-layer_um / penetration_um));
}

}  // namespace

TEST_CASE("a job gets warnings of its overcure below undersides, however little resin a vat holds") {
    for (const double penetration_um : {60.0, 100.0}) {
        const machine::Printer printer = printer_with(penetration_um);
        const Screen screen(printer.projector, std::nullopt);
        const Cure cure = planned_cure(printer, table(), table_image, screen, quiet).value();
        CHECK(cure.layers().empty());
        CHECK(cure.deepest_overcure_um() == near(deepest_um(penetration_um), {.relative = 1e-3}));
        CHECK(cure.deepest_overcure().z_um == 500);
        const auto warnings = overcure_warnings(cure, printer);
        if (penetration_um < 100) {
            CHECK(warnings.empty());  // 104 um
        } else {
            REQUIRE(warnings.size() == 1);
            CHECK(warnings[0].find("overcure: light will cure 0.003 mm^3 of soft more than 120 um below") == 0);
        }
    }
}

TEST_CASE("an image's exposure in the manifest is used, and a missing image is an error") {
    const machine::Printer printer = printer_with(60);
    const Screen screen(printer.projector, std::nullopt);
    job::Manifest job = table();
    job.layers[10].images[0].exposure_s = 20;
    const Cure cure = planned_cure(printer, job, table_image, screen, quiet).value();
    CHECK(cure.deepest_overcure_um() > cure_depth_um);
    CHECK(overcure_warnings(cure, printer).size() == 1);
    const RunSource none = [](int, int) -> Result<Runs> { return input_error("gone"); };
    CHECK_FALSE(planned_cure(printer, job, none, screen, quiet));
}

TEST_CASE("the look at a job tells how far it is, and can be cancelled") {
    class After final : public Progress {
    public:
        explicit After(std::size_t layers) : layers_(layers) {}
        void advance(std::string_view stage, double fraction) override {
            CHECK(stage == "overcure");
            CHECK(fraction == near(static_cast<double>(told++) / 40, {.absolute = 1e-12}));
        }
        [[nodiscard]] bool cancelled() const override { return told == layers_; }
        std::size_t told = 0;

    private:
        std::size_t layers_;
    };
    const machine::Printer printer = printer_with(60);
    const Screen screen(printer.projector, std::nullopt);
    After whole(100), seven(7);
    CHECK(planned_cure(printer, table(), table_image, screen, whole));
    CHECK(whole.told == 40);
    CHECK(planned_cure(printer, table(), table_image, screen, seven).error().cause == Cause::cancelled);
    CHECK(seven.told == 7);
}
