#include "job/export.hpp"

#include <doctest/doctest.h>

#include "core/files.hpp"
#include "core/test_folder.hpp"
#include "job/make_job.hpp"
#include "job/png.hpp"
#include "slice/test_shapes.hpp"
#include "zip/zip_file.hpp"

using namespace pliant;
using namespace pliant::job;
using slice::test::box;
namespace fs = std::filesystem;

namespace {

JobSettings settings() {
    JobSettings s{
        "two", "0.1.0", 2, {{64, 48, 100}, 50, {}}, {{"soft", "flex", 0, 0, 3, 9}, {"rigid", "hard", 0, 0, 4, 12}}};
    return s;
}

/// Soft in layers 0 to 3, rigid in 4 to 9.
Archive make(const fs::path& path) {
    const std::vector<slice::Body> bodies{{"soft", box({-1000, -1000, 0}, {1000, 1000, 200}), ""},
                                          {"rigid", box({-1000, -1000, 200}, {500, 1000, 500}), ""}};
    auto writer = Writer::create(path);
    REQUIRE(writer.has_value());
    Progress progress;
    const auto made = slice_to_job(bodies, settings(), *writer, progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    REQUIRE(writer->finish(made->manifest).has_value());
    auto archive = Archive::open(path);
    REQUIRE(archive.has_value());
    return std::move(*archive);
}

/// How many pixels of an exported image are lit.
long lit(const Result<std::string>& png) {
    REQUIRE(png.has_value());
    const auto image = decode_png(*png, {64, 48}, "x");
    REQUIRE(image.has_value());
    long sum = 0;
    for (const auto p : image->pixels) sum += p > 0;
    return sum;
}

}  // namespace

TEST_CASE("every format has every layer of every material, blank ones too") {
    const pliant::test::Folder folder("export");
    const Archive archive = make(folder / "two.zip");
    const auto sl1 = export_job(archive, Format::sl1, folder / "a");
    REQUIRE_MESSAGE(sl1.has_value(), (sl1 ? "" : sl1.error().message));
    REQUIRE(sl1->size() == 2);
    CHECK(sl1->at(1).filename() == "two_rigid.sl1");
    auto zip = ZipReader::open(sl1->at(1));
    REQUIRE(zip.has_value());
    CHECK(zip->entry_count() == 13);
    CHECK(lit(zip->read("two00003.png", 1 << 20)) == 0);
    CHECK(lit(zip->read("two00004.png", 1 << 20)) == 15 * 20);
    CHECK(zip->read("config.ini", 1 << 20)->find("expTimeFirst = 12\n") != std::string::npos);
    CHECK(zip->read("config.ini", 1 << 20)->find("usedMaterial = 0.000900\n") != std::string::npos);  // ml
    CHECK(zip->read("prusaslicer.ini", 1 << 20)->find("display_width = 6.4\n") != std::string::npos);

    const auto nano = export_job(archive, Format::nanodlp, folder / "b");
    zip = ZipReader::open(nano.value().at(0));
    CHECK(zip->entry_count() == 15);
    CHECK(lit(zip->read("1.png", 1 << 20)) == 400);
    CHECK(lit(zip->read("10.png", 1 << 20)) == 0);
    CHECK(zip->read("plate.json", 1 << 20)->find("\"LayersCount\": 10") != std::string::npos);
    CHECK(ZipReader::open(export_job(archive, Format::zip, folder / "b").value().at(1))->entry_count() == 10);

    const auto vats = export_job(archive, Format::vats, folder / "c");
    REQUIRE(vats.has_value());
    CHECK(lit(read_file(folder / "c/vat_a/vata_layer_0000.png")) == 400);
    CHECK(lit(read_file(folder / "c/vat_b/vatb_layer_0009.png")) == 300);
    CHECK(format_from("png").error().message == "format \"png\": must be sl1, nanodlp, zip or vats");
}

TEST_CASE("layers of many heights go only where each layer stands alone") {
    const pliant::test::Folder folder("export");
    JobSettings s = settings();
    s.slicing.tops_um = {50, 150};
    const fs::path path = folder / "many.zip";
    auto writer = Writer::create(path);
    Progress progress;
    const auto made =
        slice_to_job(std::vector<slice::Body>{{"soft", slice::test::box({-500, -500, 0}, {500, 500, 400}), ""}}, s,
                     *writer, progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    REQUIRE(writer->finish(made->manifest).has_value());
    const Archive archive = Archive::open(path).value();
    const auto refused = export_job(archive, Format::sl1, folder / "a");
    REQUIRE(!refused.has_value());
    CHECK(refused.error().message ==
          "layer 1 is 100 um thick, layer 0 50 um: this format knows layers of one thickness only");
    CHECK(export_job(archive, Format::vats, folder / "b").has_value());
}

TEST_CASE("equal jobs give equal bytes") {
    const pliant::test::Folder folder("export");
    const Archive archive = make(folder / "two.zip");
    const auto first = read_file(export_job(archive, Format::nanodlp, folder / "a").value()[0]);
    CHECK(first.value() == read_file(export_job(archive, Format::nanodlp, folder / "b").value()[0]).value());
}

TEST_CASE("what was exported comes back as a job, from zip files and from folders") {
    const pliant::test::Folder folder("export");
    const Archive archive = make(folder / "two.zip");
    (void)export_job(archive, Format::sl1, folder / "a");
    (void)export_job(archive, Format::vats, folder / "c");
    CHECK(is_image_stack(folder / "a/two_soft.sl1"));
    CHECK(!is_image_stack(folder / "two.zip"));
    std::vector<MaterialStack> stacks;
    stacks.push_back({"soft", ImageStack::open(folder / "a/two_soft.sl1").value()});
    stacks.push_back({"rigid", ImageStack::open(folder / "c/vat_b").value()});
    auto writer = Writer::create(folder / "back.zip");
    Progress progress;
    const auto made = stacks_to_job(stacks, settings(), *writer, progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    const Manifest &before = archive.manifest(), &after = made->manifest;
    REQUIRE(after.layers.size() == before.layers.size());
    for (std::size_t k = 0; k < after.layers.size(); ++k) {
        REQUIRE(after.layers[k].images.size() == 1);
        CHECK(after.layers[k].images[0].material == before.layers[k].images[0].material);
        CHECK(after.layers[k].images[0].area_mm2 == before.layers[k].images[0].area_mm2);
    }
    CHECK(after.materials[1].model_volume_mm3 == doctest::Approx(0.9));
    CHECK(after.warnings.empty());
}

TEST_CASE("pixels that two stacks light go to one of them, and it is said") {
    const pliant::test::Folder folder("export");
    fs::create_directories(folder / "x");
    slice::RunImage image(64, 48);
    image.append(10, 0, 50, 255);
    REQUIRE(write_file(folder / "x/l1.png", encode_png(image)).has_value());
    std::vector<MaterialStack> stacks;
    stacks.push_back({"soft", ImageStack::open(folder / "x").value()});
    stacks.push_back({"rigid", ImageStack::open(folder / "x").value()});
    auto writer = Writer::create(folder / "job.zip");
    Progress progress;
    const auto made = stacks_to_job(stacks, settings(), *writer, progress);
    REQUIRE(made.has_value());
    REQUIRE(made->manifest.layers.at(0).images.size() == 1);
    CHECK(made->manifest.layers[0].images[0].material == 1);
    CHECK(made->manifest.warnings.at(0) ==
          "images of \"soft\": 0.025 mm^3 are lit by other materials too, which keep them");
}

TEST_CASE("stacks with gaps, without images and of other sizes are refused") {
    const pliant::test::Folder folder("export");
    CHECK(ImageStack::open(folder.path()).error().message.find("holds no layer images") != std::string::npos);
    const std::string png = encode_png(slice::RunImage(30, 20));
    (void)write_file(folder / "a1.png", png);
    (void)write_file(folder / "a3.png", png);
    CHECK(ImageStack::open(folder.path()).error().message.find("a3.png follows a1.png") != std::string::npos);
    (void)write_file(folder / "a2.png", png.substr(0, 60));
    auto stack = ImageStack::open(folder.path());
    REQUIRE(stack.has_value());
    CHECK(stack->layer_count() == 3);
    CHECK(!stack->image(1).has_value());
    std::vector<MaterialStack> stacks;
    stacks.push_back({"soft", std::move(*stack)});
    auto writer = Writer::create(folder / "job.zip");
    Progress progress;
    CHECK(stacks_to_job(stacks, settings(), *writer, progress).error().message ==
          "images of 'soft' have 30 x 20 pixels, the projector 64 x 48");
}
