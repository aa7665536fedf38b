// Jobs from a file to the host: opened, verified, prepared.
#include "printing/operate/job_file.hpp"

#include <doctest/doctest.h>

#include <functional>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "printing/job/png.hpp"
#include "printing/operate/print_job.hpp"
#include "printing/operate/programs.hpp"
#include "printing/operate/proved_job.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/safe_stop.hpp"

using namespace pliant;
using namespace pliant::operate;
using pliant::test::holds;
namespace fs = std::filesystem;

namespace {

constexpr int width_px = 8, height_px = 6;

/// One half of the projector for each material, the left for the first.
job::Image image_of_half(int material) {
    job::Image image{width_px, height_px, std::vector<std::uint8_t>(width_px * height_px)};
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = (i % width_px < width_px / 2) == (material == 0) ? 255 : 0;
    return image;
}

/// A job of 3 layers for the tower of the examples with a projector of 48 pixels.
struct Job {
    const pliant::test::Folder folder;
    const fs::path path = folder / "halves.zip";
    std::string printer_text = read_file("examples/printers/tower.toml").value();
    machine::Printer printer;
    job::Manifest manifest;
    std::string gcode;
    bool with_printer = true, with_mask = false;

    Job() {
        set("width", std::to_string(width_px));
        set("height", std::to_string(height_px));
        printer = machine::parse_printer(printer_text, "tower.toml").value();
        const double mm2 = printer.projector.pixel_um * printer.projector.pixel_um / 1e6 * width_px * height_px / 2;
        manifest.name = "halves";
        manifest.width_px = width_px;
        manifest.height_px = height_px;
        manifest.pixel_um = printer.projector.pixel_um;
        manifest.bottom_layers = 1;
        manifest.materials = {{"soft", printer.vats[0].resin, 0.15 * mm2, 1, 2.5, 12},
                              {"firm", printer.vats[1].resin, 0.15 * mm2, 1, 2.5, 12}};
        for (int k = 0; k < 3; ++k) {
            manifest.layers.push_back({50 * (k + 1), 50, {}});
            for (int m = 0; m < 2; ++m)
                manifest.layers.back().images.push_back({m, fmt::format("layers/{}_{}.png", k, m), mm2});
        }
        gcode = plan::write_gcode(plan::make_plan(manifest, printer).value(), manifest, printer);
    }
    void set(const std::string& key, const std::string& value) {
        const std::size_t at = printer_text.find("\n" + key + " = ");
        REQUIRE(at != std::string::npos);
        printer_text.replace(at, printer_text.find('\n', at + 1) - at, "\n" + key + " = " + value);
    }
    void write() const {
        auto writer = job::Writer::create(path);
        REQUIRE(writer.has_value());
        for (const job::Layer& layer : manifest.layers) {
            for (const job::LayerImage& image : layer.images)
                REQUIRE(writer->add_image(image.file, image_of_half(image.material)).has_value());
        }
        if (with_printer) REQUIRE(writer->add_file("printer.toml", printer_text).has_value());
        if (with_mask) REQUIRE(writer->add_image(job::mask_entry, image_of_half(0)).has_value());
        REQUIRE(writer->add_file("job.gcode", gcode).has_value());
        const Status written = writer->finish(manifest);
        REQUIRE_MESSAGE(written, (written ? "" : written.error().message));
    }
};

}  // namespace

TEST_CASE("a job opens with its printer; a job without a printer gets a remedy") {
    Job job;
    job.write();
    const auto open = open_job(job.path);
    REQUIRE_MESSAGE(open, (open ? "" : open.error().message));
    CHECK(open->printer.name == job.printer.name);
    CHECK(image_of(open->archive, 2, 1).value() == image_of_half(1));
    for (const auto& [layer, material] : {std::pair(-1, 0), {3, 0}, {0, 2}, {0, -1}})
        CHECK(image_of(open->archive, layer, material).error().message ==
              fmt::format("layer {} has no image of material {}", layer, material));
    CHECK(holds(open_job(job.folder / "none.zip").error().message, "none.zip: no such file"));
    job.with_printer = false;
    job.write();
    CHECK(open_job(job.path).error().message ==
          job.path.string() + ": has no entry 'printer.toml'; slice the robot again with --printer");
}

TEST_CASE("a mask is read from the folder of the printer file, and from the job") {
    Job job;
    CHECK_FALSE(load_mask(job.printer.projector, job.folder / "p.toml").value().has_value());
    machine::Projector masked = job.printer.projector;
    masked.mask = "mask.png";
    CHECK(load_mask(masked, job.folder / "p.toml").error().message ==
          (job.folder / "p.toml").string() + ": projector.mask: " + (job.folder / "mask.png").string() +
              ": no such file");
    REQUIRE(write_file(job.folder / "mask.png", job::encode(image_of_half(0)).png).has_value());
    CHECK(load_mask(masked, job.folder / "p.toml").value() == image_of_half(0));
    REQUIRE(write_file(job.folder / "mask.png", job::encode(job::Image{2, 1, {1, 2}}).png).has_value());
    CHECK(holds(load_mask(masked, job.folder / "p.toml").error().message, "mask.png: "));  // another size

    job.write();
    CHECK_FALSE(mask_of(open_job(job.path)->archive, job.printer.projector).value().has_value());
    CHECK_FALSE(mask_of(open_job(job.path)->archive, masked).has_value());
    job.with_mask = true;
    job.write();
    CHECK(mask_of(open_job(job.path)->archive, masked).value() == image_of_half(0));
}

TEST_CASE("a checked job is made ready: images, materials, journal beside it, vats filled as planned") {
    const Job job;
    job.write();
    const auto ready = load_job(job.path);
    REQUIRE_MESSAGE(ready, (ready ? "" : ready.error().message));
    CHECK(ready->job.name == "halves");
    CHECK(ready->job.layers == 3);
    CHECK(ready->job.materials == std::vector<std::string>{"soft", "firm"});
    CHECK(ready->job.gcode == job.gcode);
    CHECK(ready->job.journal == fs::path(job.path.string() + ".journal"));
    CHECK(ready->job.digest == host::job_digest(read_file(job.path).value()));
    CHECK(ready->job.images(1, 0).value() == image_of_half(0));
    CHECK(ready->warnings.empty());
    CHECK(ready->job.refills.empty());
    for (const plan::VatUse& use : ready->plan.vats) {
        for (const machine::Vat& vat : ready->printer.vats) {
            if (vat.slot == use.slot) CHECK(vat.fill_ml >= use.resin_ml);
        }
    }
}

TEST_CASE("tasks before a layer are asked for once, in the order of layers") {
    Job job;
    const double uses_ml = plan::make_plan(job.manifest, job.printer)->vats.front().resin_ml;
    job.set("fill", fmt::format("\"{} ml\"", 0.6 * uses_ml));
    job.set("least", "\"0 ml\"");
    job.printer = machine::parse_printer(job.printer_text, "tower.toml").value();
    const auto plan = plan::make_plan(job.manifest, job.printer);
    REQUIRE_MESSAGE(plan, (plan ? "" : plan.error().message));
    REQUIRE_FALSE(plan->refills.empty());
    job.gcode = plan::write_gcode(*plan, job.manifest, job.printer);
    job.write();
    const auto ready = load_job(job.path);
    REQUIRE_MESSAGE(ready, (ready ? "" : ready.error().message));
    REQUIRE(ready->job.refills.size() >= plan->refills.size());
    int before = 0;
    for (const host::Refill& refill : ready->job.refills) {
        CHECK(refill.layer >= before);
        before = refill.layer;
    }
}

TEST_CASE("a changed G-code line is refused with its number, even if all checksums are right") {
    Job job;
    const std::string lit = "G1 ";
    job.gcode.insert(job.gcode.find(lit, job.gcode.size() / 2), "G1 Z9 F600\n");
    job.write();
    const auto proved = prove_job(job.path);
    REQUIRE_FALSE(proved.has_value());
    CHECK(holds(proved.error().message, "halves.zip: "));
    CHECK(holds(proved.error().message, "line "));
    CHECK_FALSE(load_job(job.path).has_value());
}

TEST_CASE("a job without a single image is refused") {
    Job job;
    for (job::Layer& layer : job.manifest.layers) layer.images.clear();
    job.gcode = "G90\nM84 S0\n";
    job.write();
    CHECK(holds(load_job(job.path).error().message, "halves.zip: the job prints nothing"));
}

TEST_CASE("a job that lights pixels beside the platform is refused by the check of its images") {
    Job job;
    job.set("size", "[\"0.5 mm\", \"6 in\"]");  // the image is 8 x 158.75 um wide
    job.write();
    CHECK(holds(prove_job(job.path, Pixels::areas).error().message,
                "halves.zip: layers/0_0.png: its light lies 0.306 mm beyond the platform at -x"));
}

TEST_CASE("a job does not pass for a printer whose image is mirrored, turned, placed or lit otherwise") {
    Job job;
    job.write();
    const auto refused = [&](const std::function<void(machine::Projector&)>& change) {
        machine::Printer other = job.printer;
        other.name = "other";
        change(other.projector);
        const auto proved = prove_job(job.path, Pixels::fingerprints, &other);
        return proved ? "" : proved.error().message;
    };
    CHECK(refused([](machine::Projector& p) { p.rotation_deg = 360; }).empty());
    CHECK(holds(refused([](machine::Projector& p) { p.mirror_x = true; }),
                "halves.zip: was sliced for another mirror_x of the projector; slice it again for other"));
    CHECK(holds(refused([](machine::Projector& p) {
                    p.mirror_y = true;
                    p.rotation_deg = 180;
                    p.offset_y_um = -10;
                }),
                "another mirror_y, rotation and offset of"));
    CHECK(holds(refused([](machine::Projector& p) { p.grey = {0, 0.5, 1}; }), "another grey of"));
}

TEST_CASE("the host's limits come from the printer file, its programs from the planner") {
    Job job;
    machine::Controller controller;
    controller.window_lines = 3;
    controller.window_bytes = 77;
    CHECK(link_options(controller).window_lines == 3);
    CHECK(link_options(controller).window_bytes == 77);
    const host::Programs programs = programs_of(job.printer);
    const machine::Interlock at_rest(job.printer);
    CHECK_FALSE(programs.bring_vat(at_rest, 99).has_value());  // no such slot
    const auto cancel = programs.cancel(at_rest);
    REQUIRE_MESSAGE(cancel, (cancel ? "" : cancel.error().message));
    CHECK(*cancel == plan::cancel_program(at_rest, job.printer));
}
