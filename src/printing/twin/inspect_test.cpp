#include "printing/twin/inspect.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "base/core/near.hpp"

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

struct Light {
    double height_mm = 0;
    job::Image image = half;
    double seconds = 2.5;
};

/// Homes, fetches the vat of slot 1 and gives the exposures.
void print(Twin& twin, const std::vector<Light>& lights) {
    const auto send = [&](const std::string& line) {
        twin.receive(line + "\n");
        twin.advance_to(twin.now() + 100);
    };
    for (const char* line : {"M84 S0", "G90", "G28 Z", "G28 X", "G28 Y", "G1 Y0.5", "G1 X355.6", "G1 Y30", "G1 X0"})
        send(line);
    for (const Light& light : lights) {
        send(fmt::format("G1 Z{:.3f}", light.height_mm));
        twin.light_on(light.image);
        twin.advance_to(twin.now() + light.seconds);
        twin.light_off();
    }
}

void print(Twin& twin, const std::vector<double>& heights_mm, double seconds = 2.5, const job::Image& image = half) {
    std::vector<Light> lights;
    for (const double z : heights_mm) lights.push_back({z, image, seconds});
    print(twin, lights);
}

double area_mm2(const job::Image& image) {
    return static_cast<double>(light_of(runs_of(image))) / 255;
}

/// A job of those images in semi-flex, one per 50 um layer, and the drawn volume.
job::Manifest job_of(const std::vector<job::Image>& images) {
    job::Manifest job = half_job();
    job.layers.clear();
    job.materials[0].model_volume_mm3 = 0;
    job.materials[0].model_area_mm2 = 20;
    for (const job::Image& image : images) {
        const int z_um = 50 * (static_cast<int>(job.layers.size()) + 1);
        job.layers.push_back({z_um, 50, {{0, fmt::format("{}", z_um), area_mm2(image)}}});
        job.materials[0].model_volume_mm3 += area_mm2(image) * 0.05;
    }
    return job;
}

/// Prints a job whose archive contains `images`, with the given exposures.
Report verdict(const job::Manifest& job, const std::vector<job::Image>& images, const std::vector<Light>& lights,
               const Judgement& judgement = {}) {
    const auto printer = small_tower();
    Twin twin(printer);
    print(twin, lights);
    const ImageSource source = [&](int layer, int) -> Result<job::Image> {
        return images[static_cast<std::size_t>(layer)];
    };
    return inspect(twin, job, source, judgement).value();
}

std::vector<Light> lights_of(const std::vector<job::Image>& images) {
    std::vector<Light> lights;
    for (const job::Image& image : images) lights.push_back({0.05 * static_cast<double>(lights.size() + 1), image});
    return lights;
}

/// The names of all findings.
std::string names(const Report& report) {
    std::string all;
    for (const Finding& f : report.findings)
        all += fmt::format("{}{}{}", all.empty() ? "" : " ", finding_name(f.kind), f.accepted ? " (accepted)" : "");
    return all;
}

Report inspected(const std::vector<double>& heights_mm, double seconds = 2.5) {
    const auto printer = small_tower();
    Twin twin(printer);
    print(twin, heights_mm, seconds);
    return inspect(twin, half_job(), half_image).value();
}

}  // namespace

TEST_CASE("correct layers pass, with the drawn volume") {
    const Report r = inspected({0.05, 0.1});
    CHECK_MESSAGE(r.passed, report_text(r));
    CHECK(r.materials[0].cured_mm3 == near(0.4, {.relative = 1e-12}));
    CHECK(r.findings.empty());
    CHECK(r.resins[0].left_ml == near(700 - 0.4e-3, {.relative = 1e-12}));
    CHECK(r.layers == 2);
    CHECK(report_json(r).find("\"passed\": true") != std::string::npos);
}

TEST_CASE("after removing the part and filling the vat a new print can begin") {
    const auto printer = small_tower();
    Twin twin(printer);
    print(twin, {0.05, 0.1});
    REQUIRE(inspect(twin, half_job(), half_image).value().passed);
    CHECK(twin.closed_layers().size() == 2);
    twin.take_part_off();
    CHECK(twin.closed_layers().empty());
    CHECK(twin.log().exposures == 0);
    CHECK(twin.cured().left_ml()[0] == near(700 - 0.4e-3, {.relative = 1e-12}));
    twin.fill_vat(1);
    twin.fill_vat(99);  // no such slot
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

TEST_CASE("a missing layer, a wrong height, a short and a repeated exposure fail") {
    const Report missing = inspected({0.05});
    CHECK_FALSE(missing.passed);
    CHECK(missing.missing_layers == 1);
    CHECK(missing.materials[0].missing_mm3 == near(0.2, {.relative = 1e-12}));
    CHECK(missing.wrong_pixels == 4);
    const Report high = inspected({0.06, 0.1});
    CHECK_FALSE(high.passed);
    CHECK(high.stray_layers == 1);
    CHECK(high.wrong_thickness == 1);
    CHECK_FALSE(inspected({0.05, 0.1}, 1).passed);
    const Report twice = inspected({0.05, 0.05, 0.1});
    CHECK_FALSE(twice.passed);
    CHECK(twice.wrong_dose_pixels == 4);
    CHECK(twice.most_dose == near(2, {.relative = 1e-12}));
}

TEST_CASE("images whose volume differs from the model's fail") {
    const auto printer = small_tower();
    Twin twin(printer);
    print(twin, {0.05, 0.1});
    job::Manifest job = half_job();
    job.materials[0].model_volume_mm3 = 0.41;
    CHECK_FALSE(inspect(twin, job, half_image)->passed);
    job.materials[0].model_area_mm2 = 0.02;  // one pixel layer of 0.5 mm around it: 0.01 mm^3 more
    CHECK(inspect(twin, job, half_image)->passed);
}

TEST_CASE("a material of which nothing is cured fails, however large its tolerance") {
    job::Manifest job = half_job();
    job.materials.push_back({"skin", "rigid-flex", 0.02, 100, 2.5, 2.5});
    const auto printer = small_tower();
    Twin twin(printer);
    print(twin, {0.05, 0.1});
    const Report r = inspect(twin, job, half_image).value();
    CHECK(r.materials[0].passed);
    CHECK(r.materials[1].tolerance_mm3 > 0.02);
    CHECK_FALSE(r.materials[1].passed);
    CHECK(names(r) == "volume");
    CHECK(r.reasons.at(0) == "skin: nothing is printed, the model has 0.02 mm^3");
}

TEST_CASE("after empty layers the job asks for its own layers, not for the gap") {
    job::Manifest job = half_job();
    job.layers = {{50, 50, {{0, "a", 4}}}, {100, 50, {}}, {150, 50, {}}, {200, 50, {{0, "b", 4}}}};
    const auto printer = small_tower();
    Twin twin(printer);
    print(twin, {0.05, 0.2});  // 2.5 s do not cure 150 um
    const MaterialReport m = inspect(twin, job, half_image).value().materials[0];
    CHECK(m.wanted_mm3 == near(0.4, {.relative = 1e-12}));
    CHECK(m.cured_mm3 == near(0.2, {.relative = 1e-12}));
    CHECK(m.missing_mm3 == near(0.2, {.relative = 1e-12}));
}

TEST_CASE("material cured in another resin than its own counts as foreign") {
    const auto printer = small_tower();
    Twin twin(printer);
    print(twin, {0.05, 0.1});
    job::Manifest job = half_job();
    job.materials[0].resin = "rigid-flex";
    const Report r = inspect(twin, job, half_image).value();
    CHECK_FALSE(r.passed);
    CHECK(r.materials[0].foreign_mm3 == near(0.4, {.relative = 1e-12}));
    CHECK(r.materials[0].missing_mm3 == 0);
}

TEST_CASE("a missing image is an error") {
    const auto printer = small_tower();
    Twin twin(printer);
    CHECK_FALSE(inspect(twin, half_job(), [](int, int) -> Result<job::Image> { return input_error("gone"); }));
}

TEST_CASE("layer images, which have no drawn surface, may differ by what showing them with grey rounds") {
    machine::Printer printer = small_tower();
    printer.projector.grey = {0, 0.8, 1};
    // A pixel covered by 201 / 255 is to get the light 0.8 + 0.4 (201 / 255 - 0.5), 233.4 / 255: shown are 233, for
    // 200.
    const job::Image shown{4, 2, {255, 233, 0, 0, 255, 255, 0, 0}};
    job::Manifest job = half_job();
    const double area_mm2 = (3 * 255 + 201) / 255.0;
    for (job::Layer& layer : job.layers) layer.images[0].area_mm2 = area_mm2;
    const auto verdict = [&](double model_mm3, double model_area_mm2) {
        job.materials[0].model_volume_mm3 = model_mm3;
        job.materials[0].model_area_mm2 = model_area_mm2;
        Twin twin(printer);
        print(twin, {0.05, 0.1}, 2.5, shown);
        return inspect(twin, job, ImageSource([&](int, int) -> Result<job::Image> { return shown; })).value();
    };
    const Report good = verdict(area_mm2 / 10, 0);
    CHECK_MESSAGE(good.passed, (good.reasons.empty() ? "" : good.reasons.front()));
    CHECK(good.materials[0].cured_mm3 - area_mm2 / 10 == near(-1.0 / 255 / 10, {.relative = 1e-9}));
    CHECK(good.materials[0].tolerance_mm3 == near(0.01 * area_mm2 / 10, {.relative = 1e-12}));
    CHECK_FALSE(verdict(area_mm2 / 10 * 1.011, 0).passed);
    // What is drawn has the tolerance of its surface alone.
    CHECK_FALSE(verdict(area_mm2 / 10, 1e-6).passed);
}

TEST_CASE("the inspection accounts for the projector's grey and mask") {
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
    CHECK(good.materials[0].cured_mm3 == near(area_mm2 / 10, {.relative = 1e-12}));
    // The same images on a projector without that mask, and images without mask on this projector.
    const Report uneven = verdict(Options{}, shown);
    CHECK(!uneven.passed);
    CHECK(uneven.reasons.at(0).find("on this projector the images hold") != std::string::npos);
    const Report bright = verdict(options, {4, 2, {255, 204, 0, 0, 255, 204, 0, 0}});
    CHECK(!bright.passed);
    CHECK(bright.log.overlit_pixels == 4);
}

namespace {

const job::Image corner{4, 2, {255, 0, 0, 0, 0, 0, 0, 0}};
const job::Image all_lit{4, 2, {255, 255, 255, 255, 255, 255, 255, 255}};
const std::vector<job::Image> pyramid{all_lit, half, corner};

}  // namespace

TEST_CASE("ten times the exposure, and 10 % more or less, are a wrong dose and nothing else") {
    for (const double share : {10.0, 1.1, 0.9}) {
        std::vector<Light> lights = lights_of(pyramid);
        lights[1].seconds *= share;
        const Report r = verdict(job_of(pyramid), pyramid, lights);
        CHECK(!r.passed);
        CHECK(names(r) == "dose");
        CHECK(r.wrong_dose_pixels == 4);
        CHECK((share > 1 ? r.most_dose : r.least_dose) == near(share, {.relative = 1e-12}));
        CHECK(r.first_deviation ==
              fmt::format("layer 2: 4 pixels lit {:.3g} times as long as the job says (exposure)", share));
    }
    // The manifest's own exposure counts: of the layer, of the first layers, of the material.
    job::Manifest job = job_of(pyramid);
    job.layers[1].images[0].exposure_s = 5;
    std::vector<Light> lights = lights_of(pyramid);
    CHECK(names(verdict(job, pyramid, lights)) == "dose");
    lights[1].seconds = 5;
    CHECK(verdict(job, pyramid, lights).passed);
}

TEST_CASE("swapped images of one material are found, whether swapped by projector or archive") {
    std::vector<Light> lights = lights_of(pyramid);
    std::swap(lights[0].image, lights[1].image);
    const Report shown = verdict(job_of(pyramid), pyramid, lights);
    CHECK(names(shown) == "missing missing stray");  // by volume and by pixel
    CHECK(shown.missing_pixels == 4);
    CHECK(shown.stray_pixels == 4);
    std::vector<job::Image> exchanged = pyramid;
    std::swap(exchanged[0], exchanged[1]);
    const Report archived = verdict(job_of(pyramid), exchanged, lights_of(exchanged));
    CHECK(names(archived) == "image");
    CHECK(archived.wrong_images == 2);
    CHECK(archived.first_deviation ==
          "layer 1, material \"soft\": the image holds 4.00 pixels, the manifest says 8.00 (image)");
}

TEST_CASE("one pixel darkened or added is found, even by one grey value") {
    for (const int value : {0, 254}) {
        std::vector<job::Image> images = pyramid;
        images[1].pixels[5] = static_cast<std::uint8_t>(value);
        CHECK(names(verdict(job_of(pyramid), pyramid, lights_of(images))) == "missing missing");
        const Report archived = verdict(job_of(pyramid), images, lights_of(images));
        CHECK(archived.wrong_images == 1);
        CHECK(!archived.passed);
    }
    std::vector<job::Image> stray = pyramid;
    stray[2].pixels[7] = 1;
    CHECK(names(verdict(job_of(pyramid), pyramid, lights_of(stray))) == "stray");
    CHECK(verdict(job_of(pyramid), stray, lights_of(stray)).wrong_images == 1);
}

TEST_CASE("a cause that spoils every layer is told by a few of them") {
    Report r;
    r.findings.push_back({Finding::Kind::missing, "nothing is printed"});
    for (int k = 1; k <= 200; ++k) r.findings.push_back({Finding::Kind::light, fmt::format("gap {}", k)});
    for (int m = 1; m <= 5; ++m) r.findings.push_back({Finding::Kind::volume, fmt::format("material {}", m)});
    const std::string text = report_text(r);
    CHECK(text.find("  wrong (missing): nothing is printed\n  wrong (light): gap 1\n  wrong (light): gap 2\n"
                    "  wrong (light): gap 3\n  and 197 more (light)\n  wrong (volume): material 1\n") !=
          std::string::npos);
    CHECK(text.find("material 5") != std::string::npos);
    CHECK(report_json(r).find("gap 200") != std::string::npos);
}

TEST_CASE("overcure below an underside is allowed up to the known depth; more fails unless accepted") {
    // A table: twenty layers of a leg, twenty of its plate.
    std::vector<job::Image> table(20, corner);
    table.resize(40, all_lit);
    const job::Manifest job = job_of(table);
    const Report good = verdict(job, table, lights_of(table));
    CHECK_MESSAGE(good.passed, report_text(good));
    CHECK(good.deepest_overcure_um > 50);
    CHECK(good.deepest_overcure_um < 120);
    // The same light in a more transparent resin.
    machine::Printer clear = small_tower();
    for (machine::Resin& resin : clear.resins) resin.penetration_um = resin.critical_J_m2 = 0;
    const auto printed = [&](const Judgement& judgement) {
        Twin twin(clear);
        print(twin, lights_of(table));
        const ImageSource source = [&](int layer, int) -> Result<job::Image> {
            return table[static_cast<std::size_t>(layer)];
        };
        return inspect(twin, job, source, judgement).value();
    };
    const Report deep = printed({});
    CHECK(!deep.passed);
    CHECK(names(deep) == "overcure");
    // Doses of all layers add up to a geometric series: 70 um + Dp ln(1 / (1 - exp(-50 / Dp))), with a first layer.
    const double dp = 70 / std::log(1 / 0.8), step = std::exp(-50 / dp);
    const double deepest_um = 70 + dp * std::log((1 - std::pow(step, 20)) / (1 - step));
    CHECK(deep.deepest_overcure_um == near(deepest_um, {.relative = 1e-3}));
    CHECK(deep.resins[0].overcure_beyond_mm3 == near(7 * (deepest_um - 120) / 1000, {.relative = 1e-3}));
    CHECK(deep.first_deviation.find("layer 21: ") == 0);
    const Report accepted = printed({{Finding::Kind::overcure}});
    CHECK(accepted.passed);
    CHECK(names(accepted) == "overcure (accepted)");
    CHECK(report_text(accepted).find("accepted (overcure): semi-flex: ") != std::string::npos);
    CHECK(report_json(accepted).find("\"accepted\": true") != std::string::npos);
    // Bleed compensation has removed from the images what the light will cure.
    clear.resins[0].bleed_compensation_um = 600;
    CHECK(printed({}).passed);
}

TEST_CASE("only intended deviations can be accepted, and misspelt names are reported") {
    CHECK(accepted_finding("overcure").value() == Finding::Kind::overcure);
    CHECK(
        accepted_finding("missing").error().message ==
        "the finding \"missing\" cannot be accepted: the print is not the job; what can be accepted: volume, overcure, "
        "contamination, cleaning");
    CHECK(accepted_finding("overcured").error().message.find("did you mean \"overcure\"") != std::string::npos);
    std::vector<Light> lights = lights_of(pyramid);
    lights[0].seconds = 30;
    CHECK_FALSE(verdict(job_of(pyramid), pyramid, lights, {{Finding::Kind::overcure, Finding::Kind::volume}}).passed);
}

TEST_CASE("the volume tolerance: half a layer at surfaces, and rounding of grey values") {
    // A cube of 5 mm, pixels of 158.75 um, layers of 50 um: 3 %, where 1 % and half a pixel were 10.5 %.
    const double border_um = border_error_um(158.75, true, false);
    CHECK(border_um == near(0.4402, {.relative = 1e-3}));
    CHECK(volume_tolerance_mm3(150, border_um, 50) == near(3.7506, {.relative = 1e-4}));
    CHECK(border_error_um(158.75, false, false) == near(79.375, {.relative = 1e-12}));
    CHECK(border_error_um(158.75, true, true) == near(20.4402, {.relative = 1e-4}));
    CHECK(border_error_um(30, true, true) == near(15 + 30 * 1.41421356 / 510, {.relative = 1e-9}));
}

TEST_CASE("what cures beside the platform fails the print, and cannot be accepted") {
    auto printer = small_tower();
    printer.projector.width_px = 8;
    printer.projector.height_px = 4;
    const job::Image corner{
        8, 4, {255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}};
    job::Manifest job = job_of({corner});
    job.width_px = 8;
    job.height_px = 4;
    const auto verdict_on = [&](int width_um, int depth_um) {
        printer.platform.width_um = width_um;
        printer.platform.depth_um = depth_um;
        Twin twin(printer);
        print(twin, {{0.05, corner}});
        return inspect(twin, job, [&](int, int) -> Result<job::Image> { return corner; }).value();
    };
    CHECK(verdict_on(8000, 4000).passed);
    CHECK(verdict_on(6000, 4000).passed);  // the pixel touches the edge
    const Report report = verdict_on(4500, 4000);
    CHECK(names(report) == "platform");
    CHECK(report.reasons.at(0) ==
          "the part lies 1.250 mm beyond the platform at -x, which reaches from -2.250 to 2.250 mm there");
    CHECK(report.first_deviation == "layer 1: cured beside the platform");
    CHECK_FALSE(accepted_finding("platform"));
}

TEST_CASE("a fault that did not occur fails the print; one that the machine cannot have is refused") {
    const auto printer = small_tower();
    const auto verdict_with = [&](const char* text) {
        twin::Options options;
        options.faults = {parse_fault(text).value()};
        Twin twin(printer, options);
        print(twin, {0.05, 0.1});
        return inspect(twin, half_job(), half_image, {{}, 0.01, true}).value();
    };
    const Report missed = verdict_with("lose-byte:999999999");
    CHECK(names(missed) == "fault");
    CHECK(missed.reasons.at(0) == "the fault lose-byte:999999999 did not occur");
    CHECK(names(verdict_with("dark-projector:3:2")) == "fault");
    CHECK(names(verdict_with("lose-ok:2")).empty());
    CHECK(names(verdict_with("empty-vat:1")).find("fault") == std::string::npos);

    const auto refused = [](const char* text, const machine::Printer& machine) {
        const Status status = check_faults({parse_fault(text).value()}, machine);
        return status ? std::string() : status.error().message;
    };
    machine::Printer plain = printer;
    plain.limit_switches.clear();
    plain.door = {};
    plain.pump = {};
    CHECK(refused("stuck-switch", printer).empty());
    CHECK(
        refused("stuck-switch", plain) ==
        "--fault stuck-switch:1: cannot occur: the tower prototype lists no [[limit_switch]] for the host to look at");
    CHECK(refused("dead-switch:9", plain).find("has 3 limit switches") != std::string::npos);
    CHECK(refused("weak-magnet", printer).find("has no magnet") != std::string::npos);
    CHECK(refused("stuck-fork", printer).find("has no retriever") != std::string::npos);
    CHECK(refused("door-open:2:5", plain).find("--fault door-open:2:5: cannot occur") == 0);
    CHECK(refused("empty-vat:99", plain).find("has no vat in slot 99") != std::string::npos);
    CHECK(refused("dead-pump", plain).find("has no pump") != std::string::npos);
    CHECK(refused("stuck-hook", machine::load_printer("examples/printers/rotary.toml").value()).find("has no hooks") !=
          std::string::npos);
    CHECK(refused("lose-byte:999999999", plain).empty());
}
