#include "printing/prepare/make_job.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "printing/job/verify.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::job;
using slice::test::box;
namespace fs = std::filesystem;

namespace {

JobSettings halves_settings() {
    return {"halves",
            "0.1.0",
            2,
            {{64, 48, 100}, 50, {}},
            {{"soft one", "flex", -1, -1, 3, 9}, {"soft/one", "hard", 0, 0, 4, 12}, {"unused", "x", 0, 0, 1, 1}}};
}

const std::vector<slice::Body> halves{{"soft one", box({-1000, -1000, 0}, {50, 1000, 500}), ""},
                                      {"soft/one", box({50, -1000, 0}, {1000, 1000, 1000}), ""},
                                      {"soft one", box({-1000, -1000, 500}, {-500, 1000, 700}), ""}};

}  // namespace

TEST_CASE("a layer so thick that its exposure would be over the printer's limit is named") {
    JobSettings settings = halves_settings();
    settings.exposures["soft one"] = {2, 0, 50, 50, {}};
    settings.most_exposure_s = 60;
    settings.printer = "tower";
    const auto made = [&] {
        const pliant::test::Folder folder("job");
        auto writer = Writer::create(folder / "job.zip");
        REQUIRE(writer.has_value());
        Progress progress;
        const auto job = slice_to_job(halves, settings, *writer, progress);
        return job ? std::string() : job.error().message;
    };
    // 3 s * exp(3) = 60.3 s
    settings.slicing.tops_um = {50, 100, 300};
    CHECK(made() ==
          "material \"soft one\": layer 3, 200 um thick, needs an exposure of 60.26 s; the limit of tower is 60 s, "
          "which allows layers of up to 199 um");
    settings.slicing.tops_um = {50, 100, 299};
    CHECK(made().empty());
}

TEST_CASE("a part too tall for the machine is refused before a layer is made") {
    JobSettings settings = halves_settings();
    settings.printer = "tower";
    int layers = 0;
    settings.watch = [&](const Manifest&, int, const std::vector<EncodedImage>&) { ++layers; };
    const auto made = [&](int build_height_um) {
        const pliant::test::Folder folder("job");
        auto writer = Writer::create(folder / "job.zip");
        REQUIRE(writer.has_value());
        Progress progress;
        settings.build_height_um = build_height_um;
        const auto job = slice_to_job(halves, settings, *writer, progress);
        return job ? std::string() : job.error().message;
    };
    CHECK(made(999) == "halves is 1.00 mm tall, tower builds 1.00 mm");
    CHECK(layers == 0);
    CHECK(made(1000).empty());
    CHECK(layers == 20);
}

TEST_CASE("separate pieces are told, and that a 3MF file places them as items of its own") {
    const std::vector<slice::Body> apart{{"soft one", box({-1000, -1000, 0}, {-500, 1000, 500}), ""},
                                         {"soft one", box({500, -1000, 0}, {1000, 1000, 500}), ""}};
    JobSettings settings = halves_settings();
    const auto warnings = [&] {
        const pliant::test::Folder folder("job");
        auto writer = Writer::create(folder / "job.zip");
        REQUIRE(writer.has_value());
        Progress progress;
        return slice_to_job(apart, settings, *writer, progress).value().manifest.warnings;
    };
    const std::string apart_text = "the part falls apart into 2 separate pieces; 1 expected";
    CHECK(std::ranges::count(warnings(), apart_text) == 1);
    settings.items = 2;
    CHECK(std::ranges::count(warnings(), apart_text +
                                             ". The 3MF file has 2 items, which are printed where they stand in it: "
                                             "move together there what is one part, or take out what is not to be "
                                             "printed") == 1);
    settings.copies = 2;
    for (const std::string& warning : warnings()) CHECK(warning.find("falls apart") == std::string::npos);
}

TEST_CASE("two materials become a job with the right layers, areas and volumes") {
    const pliant::test::Folder folder("job");
    const fs::path path = folder / "job.zip";
    auto writer = Writer::create(path);
    REQUIRE(writer.has_value());
    Progress progress;
    const auto made = slice_to_job(halves, halves_settings(), *writer, progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    REQUIRE(writer->add_file("plan.json", "{}").has_value());
    REQUIRE(writer->finish(made->manifest).has_value());

    const auto archive = Archive::open(path);
    REQUIRE_MESSAGE(archive.has_value(), (archive ? "" : archive.error().message));
    const Manifest& m = archive->manifest();
    CHECK(m.name == "halves");
    CHECK(m.bottom_layers == 2);
    CHECK(exposure_s(m, 1, 0) == 9);
    CHECK(exposure_s(m, 1, 1) == 12);
    REQUIRE(m.materials.size() == 2);
    CHECK(m.materials[0].resin == "flex");
    CHECK(m.materials[1].bottom_exposure_s == 12);
    CHECK(m.materials[0].model_volume_mm3 == near(1.05 * 2 * 0.5 + 0.5 * 2 * 0.2, {.relative = 1e-12}));
    CHECK(m.materials[0].model_area_mm2 ==
          near(2 * (1.05 * 2 + 1.05 * 0.5 + 2 * 0.5) + 2 * (0.5 * 2 + 0.5 * 0.2 + 2 * 0.2), {.relative = 1e-12}));
    CHECK(m.materials[1].model_volume_mm3 == near(0.95 * 2 * 1, {.relative = 1e-12}));
    REQUIRE(m.layers.size() == 20);
    CHECK(m.layers[19].z_um == 1000);
    CHECK(m.layers[0].images.size() == 2);
    CHECK(m.layers[13].images.size() == 2);
    CHECK(m.layers[14].images.size() == 1);
    // The interface is in the middle of a column, which goes entirely to the later material.
    CHECK(m.layers[0].images[0].area_mm2 == near(2.0, {.relative = 1e-12}));
    CHECK(m.layers[0].images[1].area_mm2 == near(2.0, {.relative = 1e-12}));
    CHECK(m.layers[12].images[0].area_mm2 == near(1.0, {.relative = 1e-12}));
    CHECK(m.layers[0].images[0].file == "layers/00000_soft_one.png");
    CHECK(m.layers[0].images[0].file != m.layers[0].images[1].file);
    const Image image = archive->image(m.layers[12].images[0].file).value();
    CHECK(int{image.at(24, 22)} == 255);
    CHECK(int{image.at(24, 26)} == 255);
    CHECK(int{image.at(24, 27)} == 0);
}

TEST_CASE("a material with fewer bottom layers than another one is exposed as its own number says") {
    const pliant::test::Folder folder("job");
    auto writer = Writer::create(folder / "job.zip");
    REQUIRE(writer.has_value());
    JobSettings settings = halves_settings();
    settings.materials[1].bottom_layers = 1;
    settings.exposures["soft/one"] = {1, 1, 0, 50, {}};
    Progress progress;
    const auto made = slice_to_job(halves, settings, *writer, progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    const double soft[] = {9, 9, 3, 3}, firm[] = {12, 8, 4, 4};
    for (std::size_t k = 0; k < 4; ++k) {
        CHECK(exposure_s(made->manifest, k, 0) == near(soft[k], {.relative = 1e-12}));
        CHECK(exposure_s(made->manifest, k, 1) == near(firm[k], {.relative = 1e-12}));
    }
}

TEST_CASE("slicing twice gives the same bytes of archive") {
    const pliant::test::Folder folder("job");
    std::vector<std::string> bytes;
    for (const char* name : {"a.zip", "b.zip"}) {
        auto writer = Writer::create(folder / name);
        Progress progress;
        const auto made = slice_to_job(halves, halves_settings(), *writer, progress);
        REQUIRE(made.has_value());
        REQUIRE(writer->finish(made->manifest).has_value());
        bytes.push_back(read_file(folder / name).value());
    }
    CHECK(bytes[0] == bytes[1]);
}

TEST_CASE("a material without settings, an invalid body and cancellation stop the job") {
    const pliant::test::Folder folder("job");
    auto writer = Writer::create(folder / "a.zip");
    Progress progress;
    JobSettings incomplete = halves_settings();
    incomplete.materials.resize(1);
    CHECK(slice_to_job(halves, incomplete, *writer, progress).error().message ==
          "material \"soft/one\" has no resin and exposure");
    CHECK(!slice_to_job({}, halves_settings(), *writer, progress).has_value());
    struct Cancel : Progress {
        [[nodiscard]] bool cancelled() const override { return true; }
    } cancel;
    CHECK(slice_to_job(halves, halves_settings(), *writer, cancel).error().cause == Cause::cancelled);
}

TEST_CASE("features narrower than asked for are named with material, layers and place") {
    const pliant::test::Folder folder("job");
    auto writer = Writer::create(folder / "job.zip");
    REQUIRE(writer.has_value());
    JobSettings asked = halves_settings();
    asked.least_feature_um = 600;
    const std::vector<slice::Body> fin{{"soft one", box({-1000, -1000, 0}, {1000, 1000, 500}), ""},
                                       {"soft one", box({-100, -1000, 500}, {100, 1000, 700}), ""}};
    Progress progress;
    const auto made = slice_to_job(fin, asked, *writer, progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    REQUIRE(made->manifest.warnings.size() == 1);
    CHECK(made->manifest.warnings.front() ==
          "material \"soft one\": 1 feature narrower than 0.6 mm in layers 11 to 14; the largest, 0.4 mm^2, begins in "
          "layer 11 at row 14, column 31");
}

TEST_CASE("exposures of layers, layer heights, bonds and findings are written to the manifest") {
    const pliant::test::Folder folder("job");
    const fs::path path = folder / "job.zip";
    auto writer = Writer::create(path);
    REQUIRE(writer.has_value());
    Progress progress;
    JobSettings s = halves_settings();
    s.exposures["soft one"] = {2, 1, 0, 50, {{4, 4, 7}}};
    s.slicing.tops_um = {50, 100, 200, 250, 300};
    s.slicing.bonds = {{"soft one", "soft/one", 2, 0}};
    std::vector<slice::Body> bodies = halves;
    bodies.push_back({"soft/one", box({1500, 0, 300}, {2000, 500, 700}), ""});
    const auto made = slice_to_job(bodies, s, *writer, progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    REQUIRE(writer->finish(made->manifest).has_value());
    const auto archive = Archive::open(path);
    REQUIRE_MESSAGE(archive.has_value(), (archive ? "" : archive.error().message));
    const Manifest& m = archive->manifest();
    CHECK(m.compensated);
    CHECK(m.layers[2].thickness_um == 100);
    CHECK(m.layers[2].z_um == 200);
    CHECK(m.layers[6].z_um == 400);
    const double wanted[] = {9, 9, 6, 3, 7, 3};
    for (std::size_t k = 0; k < 6; ++k) CHECK(exposure_s(m, k, 0) == near(wanted[k], {.relative = 1e-12}));
    CHECK(exposure_s(m, 2, 1) == 4);
    // Two columns of 20 pixels of 0.01 mm^2.
    CHECK(m.layers[0].images[0].shared_mm2 == near(0.4, {.relative = 1e-12}));
    CHECK(m.layers[0].images[1].shared_mm2 == 0);
    REQUIRE(m.findings.size() == 1);
    CHECK(m.findings[0].kind == "island");
    CHECK(m.findings[0].first_layer == 5);
    CHECK(m.findings[0].area_mm2 == near(0.25, {.relative = 1e-12}));
    CHECK(archive->has_file(m.findings[0].picture));
    CHECK(verify_images(*archive, false, "job.zip").has_value());
}

TEST_CASE("a job is compensated by an overlap only where its materials meet") {
    const auto made = [&](const std::vector<slice::Body>& bodies) {
        const pliant::test::Folder folder("job");
        auto writer = Writer::create(folder / "job.zip");
        REQUIRE(writer.has_value());
        JobSettings s = halves_settings();
        s.slicing.bonds = {{"soft one", "soft/one", 2, 0}};
        Progress progress;
        auto job = slice_to_job(bodies, s, *writer, progress);
        REQUIRE_MESSAGE(job.has_value(), (job ? "" : job.error().message));
        return std::move(job->manifest);
    };
    CHECK(made({halves[0], halves[1]}).compensated);
    const Manifest apart = made({{"soft one", box({-1000, -1000, 0}, {-500, 1000, 500}), ""},
                                 {"soft/one", box({500, -1000, 0}, {1000, 1000, 500}), ""}});
    CHECK(!apart.compensated);
    CHECK(std::count(apart.warnings.begin(), apart.warnings.end(),
                     "overlap: soft one and soft/one meet nowhere, no pixel is exposed twice") == 1);
}

TEST_CASE("an interlock of materials that are exposed together is told to change nothing") {
    const pliant::test::Folder folder("job");
    auto writer = Writer::create(folder / "job.zip");
    REQUIRE(writer.has_value());
    JobSettings s = halves_settings();
    s.materials[1].resin = s.materials[0].resin;
    s.materials[1].exposure_s = s.materials[0].exposure_s;
    s.materials[1].bottom_exposure_s = s.materials[0].bottom_exposure_s;
    s.slicing.teeth = {{"soft one", "soft/one", 2, 1}};
    Progress progress;
    const auto job = slice_to_job(halves, s, *writer, progress);
    REQUIRE_MESSAGE(job.has_value(), (job ? "" : job.error().message));
    const std::vector<std::string>& told = job->manifest.warnings;
    CHECK(std::count(told.begin(), told.end(),
                     "interlock: soft one and soft/one are printed from one vat and exposed together, it changes "
                     "nothing") == 1);
}

TEST_CASE("what a black mask of the projector leaves dark is told for each material; a wholly dark job is an error") {
    const pliant::test::Folder folder("job");
    JobSettings settings = halves_settings();
    settings.light.mask = slice::Image{64, 48, std::vector<std::uint8_t>(std::size_t{64} * 48, 255)};
    std::vector<std::uint8_t>& mask = settings.light.mask->pixels;
    const auto made = [&] {
        auto writer = Writer::create(folder / "job.zip");
        REQUIRE(writer.has_value());
        Progress progress;
        return slice_to_job(halves, settings, *writer, progress);
    };
    const auto told = [&] {
        const auto job = made();
        REQUIRE_MESSAGE(job.has_value(), (job ? "" : job.error().message));
        std::vector<std::string> lines;
        for (const std::string& line : job->manifest.warnings) {
            if (line.find("mask") != std::string::npos) lines.push_back(line);
        }
        return lines;
    };
    CHECK(told().empty());
    // Half of every layer, which is symmetric about the images' middle row. The column of the interface goes to
    // "soft/one" where "soft one" is beside it, in ten layers; in the other ten it is covered by half, as grey as 128:
    // half of 1 x 2 x 0.5 + (0.9 + 0.1 x 128 / 255) x 2 x 0.5 mm^3.
    std::fill(mask.begin() + std::ptrdiff_t{64} * 24, mask.end(), std::uint8_t{0});
    const std::vector<std::string> half = told();
    REQUIRE(half.size() == 2);
    CHECK(half[0] == "material \"soft one\": 0.6 mm^3 get no light: the projector's mask is black there");
    CHECK(half[1] == "material \"soft/one\": 0.9751 mm^3 get no light: the projector's mask is black there");
    std::fill(mask.begin(), mask.end(), std::uint8_t{0});
    CHECK(made().error().message == "nothing is printed: the projector's mask is black under the whole part");
}
