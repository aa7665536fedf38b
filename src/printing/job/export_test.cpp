#include "printing/job/export.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "base/zip/zip_file.hpp"
#include "printing/job/png.hpp"
#include "printing/prepare/make_job.hpp"
#include "printing/slice/test_shapes.hpp"

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

Result<std::vector<fs::path>> export_job(const Archive& archive, Format format, const fs::path& folder) {
    Progress silent;
    return job::export_job(archive, format, folder, silent);
}

/// Cancels in the layer of this number, counted over all materials.
class CancelAt final : public Progress {
public:
    explicit CancelAt(int layer) : left_(layer) {}
    void advance(std::string_view, double) override { --left_; }
    [[nodiscard]] bool cancelled() const override { return left_ <= 0; }

private:
    int left_;
};

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

/// Number of lit pixels in an exported image.
long lit(const Result<std::string>& png) {
    REQUIRE(png.has_value());
    const auto image = decode_png(*png, {64, 48}, "x");
    REQUIRE(image.has_value());
    long sum = 0;
    for (const auto p : image->pixels) sum += p > 0;
    return sum;
}

/// "key = value" lines.
std::map<std::string, std::string> ini(const ZipReader& zip, const std::string& file) {
    std::istringstream text(zip.read(file, 1 << 20).value());
    std::map<std::string, std::string> values;
    for (std::string line; std::getline(text, line);) {
        const std::size_t at = line.find(" = ");
        REQUIRE_MESSAGE(at != std::string::npos, line);
        values[line.substr(0, at)] = line.substr(at + 3);
    }
    return values;
}

double number(const std::map<std::string, std::string>& values, const std::string& key) {
    REQUIRE_MESSAGE(values.contains(key), key);
    std::size_t read = 0;
    const double value = std::stod(values.at(key), &read);
    CHECK_MESSAGE(read == values.at(key).size(), key);
    return value;
}

nlohmann::json json(const ZipReader& zip, const std::string& file) {
    return nlohmann::json::parse(zip.read(file, 1 << 20).value());
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
    CHECK(ZipReader::open(export_job(archive, Format::zip, folder / "b").value().at(1))->entry_count() == 11);

    const auto vats = export_job(archive, Format::vats, folder / "c");
    REQUIRE(vats.has_value());
    CHECK(lit(read_file(folder / "c/vat_a/vata_layer_0000.png")) == 400);
    CHECK(lit(read_file(folder / "c/vat_b/vatb_layer_0009.png")) == 300);
    CHECK(format_from("png").error().message == "format \"png\": must be sl1, nanodlp, zip or vats");
}

TEST_CASE("an .sl1 file can be read as PrusaSlicer and UVtools read it") {
    const pliant::test::Folder folder("export");
    const Archive archive = make(folder / "two.zip");
    const auto zip = ZipReader::open(export_job(archive, Format::sl1, folder / "a").value().at(1));
    const auto config = ini(*zip, "config.ini"), slicer = ini(*zip, "prusaslicer.ini");
    for (const char* key :
         {"action", "expTime", "expTimeFirst", "expUserProfile", "fileCreationTimestamp", "hollow", "jobDir",
          "layerHeight", "materialName", "numFade", "numFast", "numSlow", "printProfile", "printTime", "printerModel",
          "printerProfile", "printerVariant", "prusaSlicerVersion", "usedMaterial"})
        CHECK_MESSAGE(config.contains(key), key);
    CHECK(config.at("action") == "print");
    CHECK(number(config, "expTime") == 4);
    CHECK(number(config, "expTimeFirst") == 12);
    CHECK(number(config, "layerHeight") == near(0.05, {.relative = 1e-12}));          // mm
    CHECK(number(config, "numFade") == 0);                                            // two bottom layers, none fades
    CHECK(number(config, "printTime") == near(2 * 12 + 8 * 4, {.relative = 1e-12}));  // s
    CHECK(number(config, "usedMaterial") == near(1.5 * 2 * 0.3e-3, {.relative = 1e-12}));  // ml
    for (const char* key : {"printer_technology", "display_orientation", "display_mirror_x", "display_mirror_y",
                            "max_print_height", "gamma_correction", "bottle_volume", "bottle_weight", "bottle_cost"})
        CHECK_MESSAGE(slicer.contains(key), key);
    CHECK(slicer.at("printer_technology") == "SLA");
    CHECK(number(slicer, "display_pixels_x") == 64);
    CHECK(number(slicer, "display_pixels_y") == 48);
    CHECK(number(slicer, "display_width") == near(6.4, {.relative = 1e-12}));  // mm
    CHECK(number(slicer, "display_height") == near(4.8, {.relative = 1e-12}));
    CHECK(number(slicer, "layer_height") == near(0.05, {.relative = 1e-12}));
    CHECK(number(slicer, "initial_layer_height") == near(0.05, {.relative = 1e-12}));
    CHECK(number(slicer, "exposure_time") == 4);
    CHECK(number(slicer, "initial_exposure_time") == 12);
    CHECK(number(slicer, "faded_layers") == 0);
    for (int k = 0; k < static_cast<int>(number(config, "numFast")); ++k)
        CHECK(zip->has(fmt::format("{}{:05}.png", config.at("jobDir"), k)));
    CHECK(number(config, "numFast") == 10);
}

namespace {

/// A block of 8 layers of "soft" (3 s, bottom layers 9 s), exposed by `rule`.
Archive exposed(const fs::path& path, const ExposureRule& rule) {
    JobSettings s = settings();
    s.bottom_layers = rule.bottom_layers;
    s.exposures["soft"] = rule;
    auto writer = Writer::create(path);
    Progress progress;
    const auto made = slice_to_job(std::vector<slice::Body>{{"soft", box({-500, -500, 0}, {500, 500, 400}), ""}}, s,
                                   *writer, progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    REQUIRE(writer->finish(made->manifest).has_value());
    return Archive::open(path).value();
}

}  // namespace

TEST_CASE("transition layers are written to a job that has them, and only there") {
    const pliant::test::Folder folder("export");
    const Archive archive = exposed(folder / "fade.zip", {2, 3, 0, 50, {}});
    const auto sl1 = ZipReader::open(export_job(archive, Format::sl1, folder / "a").value().at(0));
    CHECK(number(ini(*sl1, "config.ini"), "numFade") == 3);
    CHECK(number(ini(*sl1, "prusaslicer.ini"), "faded_layers") == 3);
    // 2 of 9 s, then 7.5, 6 and 4.5 s, and 3 of 3 s.
    CHECK(number(ini(*sl1, "config.ini"), "printTime") == near(18 + 18 + 9, {.relative = 1e-12}));
    const auto nano = ZipReader::open(export_job(archive, Format::nanodlp, folder / "b").value().at(0));
    CHECK(json(*nano, "profile.json")["TransitionalLayer"] == 3);
    CHECK(exposure_notes(archive.manifest(), Format::nanodlp).empty());
}

TEST_CASE("a fade that is longer than the part, or begins without bottom layers, is written as it is") {
    const pliant::test::Folder folder("export");
    for (const int bottom : {2, 0}) {
        CAPTURE(bottom);
        const Archive archive = exposed(folder / "fade.zip", {bottom, 20, 0, 50, {}});
        const auto nano = ZipReader::open(export_job(archive, Format::nanodlp, folder / "b").value().at(0));
        const auto profile = json(*nano, "profile.json");
        CHECK(profile["CureTime"] == 3);
        CHECK(profile["SupportCureTime"] == 9);
        CHECK(profile["SupportLayerNumber"] == bottom);
        CHECK(profile["TransitionalLayer"] == 20);
        CHECK(exposure_notes(archive.manifest(), Format::nanodlp).empty());
    }
}

TEST_CASE("layers whose exposure a format cannot say are counted") {
    const pliant::test::Folder folder("export");
    const Archive archive = exposed(folder / "own.zip", {2, 0, 0, 50, {{4, 6, 5}}});
    CHECK(exposure_notes(archive.manifest(), Format::nanodlp) ==
          std::vector<std::string>{
              "material \"soft\": 3 layers of it should get other light than a .nanodlp file can say"});
    // The second bottom layer too: an .sl1 file has one first layer.
    CHECK(
        exposure_notes(archive.manifest(), Format::sl1) ==
        std::vector<std::string>{"material \"soft\": 4 layers of it should get other light than an .sl1 file can say"});
    CHECK(exposure_notes(archive.manifest(), Format::zip).empty());
}

TEST_CASE("a material with fewer bottom layers than its job has no layer of other light") {
    const pliant::test::Folder folder("export");
    Manifest manifest = exposed(folder / "own.zip", {1, 0, 0, 50, {}}).manifest();
    manifest.bottom_layers = 3;
    manifest.materials[0].bottom_layers = 1;
    CHECK(exposure_notes(manifest, Format::nanodlp).empty());
    CHECK(exposure_notes(manifest, Format::sl1).empty());
}

TEST_CASE("a .nanodlp file can be read as NanoDLP and UVtools read it") {
    const pliant::test::Folder folder("export");
    const Archive archive = make(folder / "two.zip");
    const auto zip = ZipReader::open(export_job(archive, Format::nanodlp, folder / "b").value().at(1));
    const auto meta = json(*zip, "meta.json"), plate = json(*zip, "plate.json"), profile = json(*zip, "profile.json"),
               slicer = json(*zip, "slicer.json"), info = json(*zip, "info.json");
    CHECK(meta["FormatVersion"] == 1);
    for (const char* key : {"Distro", "Program", "Version", "OS", "Arch"}) CHECK_MESSAGE(meta[key].is_string(), key);
    CHECK(meta["Profile"] == true);
    CHECK(plate["LayersCount"] == 10);
    CHECK(plate["XRes"] == 64);
    CHECK(plate["YRes"] == 48);
    CHECK(plate["MultiMaterial"] == false);
    // Rigid is in layers 4 to 9, x from -1 to 0.5 mm, y from -1 to 1 mm: 15 x 20 pixels of 0.1 mm.
    CHECK(plate["TotalSolidArea"].get<double>() == near(6 * 3.0, {.relative = 1e-12}));
    CHECK(plate["XMin"].get<double>() == near(-1, {.relative = 1e-12}));
    CHECK(plate["XMax"].get<double>() == near(0.5, {.relative = 1e-12}));
    CHECK(plate["YMin"].get<double>() == near(-1, {.relative = 1e-12}));
    CHECK(plate["YMax"].get<double>() == near(1, {.relative = 1e-12}));
    CHECK(plate["ZMin"].get<double>() == near(0.2, {.relative = 1e-12}));
    CHECK(plate["ZMax"].get<double>() == near(0.5, {.relative = 1e-12}));
    CHECK(profile["Depth"] == 50);  // um
    CHECK(profile["CureTime"] == 4);
    CHECK(profile["SupportCureTime"] == 12);
    CHECK(profile["SupportLayerNumber"] == 2);
    CHECK(profile["TransitionalLayer"] == 0);
    for (const char* key : {"WaitBeforePrint", "WaitAfterPrint", "TopWait"}) CHECK_MESSAGE(profile.contains(key), key);
    CHECK(slicer["PWidth"] == 64);
    CHECK(slicer["PHeight"] == 48);
    CHECK(slicer["XPixelSize"].get<double>() == near(0.1, {.relative = 1e-12}));  // mm
    CHECK(slicer["YPixelSize"].get<double>() == near(0.1, {.relative = 1e-12}));
    CHECK(slicer["Thickness"] == 50);
    CHECK(slicer["ImageMirror"] == 0);
    CHECK(slicer["LayerCount"] == 10);
    CHECK(slicer["MultiMaterial"] == false);
    REQUIRE(info.size() == 10);
    for (std::size_t k = 0; k < info.size(); ++k) {
        const bool there = k >= 4;
        CHECK(zip->has(fmt::format("{}.png", k + 1)));
        for (const char* key : {"TotalSolidArea", "LargestArea", "SmallestArea"})
            CHECK(info[k][key].get<double>() == near(there ? 3.0 : 0.0, {.relative = 1e-12}));  // mm^2
        CHECK(info[k]["AreaCount"] == (there ? 1 : 0));
        CHECK(info[k]["MinX"] == (there ? 22 : 0));
        CHECK(info[k]["MaxX"] == (there ? 36 : 0));
        CHECK(info[k]["MinY"] == (there ? 14 : 0));
        CHECK(info[k]["MaxY"] == (there ? 33 : 0));
    }
}

TEST_CASE("info.json counts the parts of a layer, and gives the largest and smallest area") {
    const pliant::test::Folder folder("export");
    const std::vector<slice::Body> bodies{{"soft", box({-2000, -500, 0}, {-1000, 500, 100}), ""},
                                          {"soft", box({0, 0, 0}, {500, 200, 100}), ""}};
    auto writer = Writer::create(folder / "pieces.zip");
    Progress progress;
    const auto made = slice_to_job(bodies, settings(), *writer, progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    REQUIRE(writer->finish(made->manifest).has_value());
    const auto archive = Archive::open(folder / "pieces.zip");
    const auto info =
        json(*ZipReader::open(export_job(*archive, Format::nanodlp, folder / "b").value().at(0)), "info.json");
    CHECK(info[1]["AreaCount"] == 2);
    CHECK(info[1]["LargestArea"].get<double>() == near(1.0, {.relative = 1e-12}));
    CHECK(info[1]["SmallestArea"].get<double>() == near(0.1, {.relative = 1e-12}));
    CHECK(info[1]["TotalSolidArea"].get<double>() == near(1.1, {.relative = 1e-12}));
}

TEST_CASE("a zip can be read as UVtools reads it, and folders of vats as documented") {
    const pliant::test::Folder folder("export");
    const Archive archive = make(folder / "two.zip");
    const auto zip = ZipReader::open(export_job(archive, Format::zip, folder / "b").value().at(0));
    for (int k = 1; k <= 10; ++k) CHECK(zip->has(fmt::format("{}.png", k)));
    const std::string text = zip->read("manifest.uvtools", 1 << 20).value();
    for (const char* line :
         {"<LayerHeight>0.05</LayerHeight>", "<ResolutionX>64</ResolutionX>", "<ResolutionY>48</ResolutionY>",
          "<DisplayWidth>6.4</DisplayWidth>", "<DisplayHeight>4.8", "<MachineZ>1</MachineZ>"})
        CHECK_MESSAGE(text.find(line) != std::string::npos, line);
    REQUIRE(export_job(archive, Format::vats, folder / "c").has_value());
    for (const char letter : {'a', 'b'}) {
        for (int k = 0; k < 10; ++k)
            CHECK(fs::exists(folder / fmt::format("c/vat_{}/vat{}_layer_{:04}.png", letter, letter, k)));
    }
}

TEST_CASE("every export that holds a layer height gives it back") {
    const pliant::test::Folder folder("export");
    const Archive archive = make(folder / "two.zip");
    for (const Format format : {Format::sl1, Format::nanodlp, Format::zip}) {
        const auto written = export_job(archive, format, folder / fmt::format("f{}", static_cast<int>(format)));
        const auto stack = ImageStack::open(written.value().at(0));
        REQUIRE(stack.has_value());
        REQUIRE(stack->layer_um().has_value());
        CHECK(*stack->layer_um() == near(50, {.relative = 1e-12}));
    }
    REQUIRE(export_job(archive, Format::vats, folder / "c").has_value());
    CHECK_FALSE(ImageStack::open(folder / "c/vat_a")->layer_um().has_value());
    REQUIRE(write_file(folder / "c/vat_a/config.ini", "layerHeight = 0").has_value());
    CHECK(ImageStack::open(folder / "c/vat_a").error().message.find("config.ini: layerHeight = \"0\"") !=
          std::string::npos);
}

TEST_CASE("layers of different heights are exported only to formats that allow them") {
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
          "layer 2 is 100 um thick, layer 1 50 um: this format knows layers of one thickness only");
    CHECK(export_job(archive, Format::vats, folder / "b").has_value());
    CHECK(height_note(archive.manifest(), Format::vats) ==
          "the layers are 50 to 100 um thick, which a folder of vats does not say; manifest.json of the job does");
    CHECK(height_note(archive.manifest(), Format::zip).find("a .zip does not say") != std::string::npos);
    CHECK(height_note(make(folder / "even.zip").manifest(), Format::zip).empty());
}

TEST_CASE("an export that is cancelled leaves no partial file, and an earlier export as it was") {
    const pliant::test::Folder folder("export");
    const Archive archive = make(folder / "two.zip");
    for (const Format format : {Format::sl1, Format::nanodlp, Format::zip, Format::vats}) {
        CAPTURE(static_cast<int>(format));
        const fs::path out = folder / fmt::format("f{}", static_cast<int>(format));
        CancelAt third(3), in_second(13);
        CHECK(job::export_job(archive, format, out, third).error().cause == Cause::cancelled);
        CHECK_FALSE(fs::exists(out.string() + ".partial"));
        CHECK((!fs::exists(out) || fs::is_empty(out)));
        CHECK_FALSE(job::export_job(archive, format, out, in_second));
        for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
            CHECK_FALSE(entry.path().string().ends_with(".partial"));
    }
    REQUIRE(export_job(archive, Format::vats, folder / "c"));
    CancelAt third(3);
    CHECK_FALSE(job::export_job(archive, Format::vats, folder / "c", third));
    CHECK(fs::exists(folder / "c/vat_b/vatb_layer_0009.png"));
}

TEST_CASE("equal jobs give equal bytes") {
    const pliant::test::Folder folder("export");
    const Archive archive = make(folder / "two.zip");
    const auto first = read_file(export_job(archive, Format::nanodlp, folder / "a").value()[0]);
    CHECK(first.value() == read_file(export_job(archive, Format::nanodlp, folder / "b").value()[0]).value());
}

TEST_CASE("an exported job can be imported again, from zip files and from folders") {
    const pliant::test::Folder folder("export");
    const Archive archive = make(folder / "two.zip");
    (void)export_job(archive, Format::sl1, folder / "a");
    (void)export_job(archive, Format::vats, folder / "c");
    CHECK(is_image_stack(folder / "a/two_soft.sl1"));
    CHECK(!is_image_stack(folder / "two.zip"));
    CHECK(is_job(folder / "two.zip"));
    CHECK(!is_job(folder / "a/two_soft.sl1"));
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
    CHECK(after.materials[1].model_volume_mm3 == near(0.9, {.relative = 1e-12}));
    CHECK(after.warnings.empty());
}

TEST_CASE("a stack has the volume of its layers, also of a first one that is thicker; grey that is applied is told") {
    const pliant::test::Folder folder("export");
    fs::create_directories(folder / "x");
    slice::RunImage image(64, 48);
    image.append(10, 0, 50, 255);
    for (const char* name : {"x/l1.png", "x/l2.png"}) REQUIRE(write_file(folder / name, encode_png(image)));
    std::vector<MaterialStack> stacks;
    stacks.push_back({"soft", ImageStack::open(folder / "x").value()});
    JobSettings s = settings();
    s.slicing.tops_um = {300, 350};
    s.light.grey = slice::grey_values(std::vector<double>{0, 0.8, 1});
    auto writer = Writer::create(folder / "job.zip");
    Progress progress;
    const auto made = stacks_to_job(stacks, s, *writer, progress);
    REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
    CHECK(made->manifest.layers.at(0).z_um == 300);
    CHECK(made->manifest.layers.at(1).z_um == 350);
    CHECK(made->manifest.materials.at(0).model_volume_mm3 == near(50 * 0.01 * 0.35, {.relative = 1e-12}));
    REQUIRE(made->manifest.warnings.size() == 1);
    CHECK(made->manifest.warnings[0].find("the printer file's grey is applied to the layer images") == 0);
}

TEST_CASE("pixels lit in two stacks go to one of them, with a warning") {
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
          "images of \"soft\": 0.025 mm^3 are exposed by other materials too, which keep them");
}

TEST_CASE("a second series of images of the same size is named, for it is left out") {
    const pliant::test::Folder folder("export");
    const std::string png = encode_png(slice::RunImage(30, 20));
    for (const char* name : {"b0.png", "b1.png", "b2.png", "a1.png", "a2.png", "cover1.png"})
        REQUIRE(write_file(folder / name, png).has_value());
    const auto stack = ImageStack::open(folder.path());
    REQUIRE(stack.has_value());
    CHECK(stack->left_out() == fmt::format("{}: the layers are the 3 images b0.png to b2.png; the 2 images a1.png to "
                                           "a2.png, which have the same size, are left out",
                                           folder.path().string()));
    // A single image is no series, and small pictures of the layers are not layers.
    REQUIRE(write_file(folder / "a1.png", encode_png(slice::RunImage(15, 10))).has_value());
    CHECK(ImageStack::open(folder.path())->left_out().empty());
    fs::remove(folder / "a2.png");
    CHECK(ImageStack::open(folder.path())->left_out().empty());
}

TEST_CASE("stacks with missing numbers, without images or of different sizes are refused") {
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
