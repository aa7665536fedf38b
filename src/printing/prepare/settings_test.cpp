#include "printing/prepare/settings.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <functional>
#include <utility>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "printing/job/png.hpp"
#include "printing/prepare/slice_job.hpp"
#include "printing/prepare/test_order.hpp"

using namespace pliant;
using namespace pliant::prepare;
using namespace pliant::prepare::test;

namespace {

using Change = std::function<void(Order&)>;

job::JobSettings settings_of(const Change& change, Drawing drawing = two_blocks()) {
    Order order;
    change(order);
    const auto settings = job_settings(order, printer(), {}, drawing);
    REQUIRE_MESSAGE(settings.has_value(), (settings ? "" : settings.error().message));
    return *settings;
}

std::string refused_settings(const Change& change) {
    Order order;
    change(order);
    Drawing drawing = two_blocks();
    const auto settings = job_settings(order, printer(), {}, drawing);
    REQUIRE(!settings.has_value());
    CHECK(settings.error().cause == Cause::input);
    return settings.error().message;
}

/// Two dark images in a folder, with the metadata of a .sl1 file of this layer height ("": none).
void write_stack(const std::filesystem::path& folder, const std::string& layer_height_mm) {
    std::filesystem::create_directories(folder);
    const std::string png = job::encode_png(slice::RunImage(200, 100));
    for (const char* name : {"part00000.png", "part00001.png"}) REQUIRE(write_file(folder / name, png).has_value());
    if (!layer_height_mm.empty())
        REQUIRE(write_file(folder / "config.ini", "layerHeight = " + layer_height_mm + "\n").has_value());
}

/// The drawing of one stack per material, with these layer heights.
Drawing stacks(const pliant::test::Folder& folder, const std::string& soft_mm, const std::string& firm_mm = "none") {
    std::vector<std::string> inputs;
    for (const auto& [name, height_mm] : {std::pair("soft", soft_mm), std::pair("firm", firm_mm)}) {
        if (height_mm == "none") continue;
        const std::filesystem::path at = folder / (std::string(name) + "_" + height_mm);
        write_stack(at, height_mm);
        inputs.push_back(std::string(name) + "=" + at.string());
    }
    Progress silent;
    auto drawing = read_drawing(inputs, {}, silent);
    REQUIRE_MESSAGE(drawing, (drawing ? "" : drawing.error().message));
    return std::move(*drawing);
}

/// The layer height, or the error.
std::string layer_or_error(const std::string& layer, Drawing drawing) {
    Order order;
    order.layer = layer;
    const auto settings = job_settings(order, printer(), {}, drawing);
    if (!settings) return settings.error().message;
    return fmt::format("{}{}", settings->slicing.layer_um, drawing.warnings.empty() ? "" : " assumed");
}

}  // namespace

TEST_CASE("a drawing's items are those of the job") {
    Drawing drawing = prepare::test::two_blocks();
    CHECK(job_settings({}, printer(), {}, drawing).value().items == 1);
    drawing.items = 3;
    CHECK(job_settings({}, printer(), {}, drawing).value().items == 3);
}

TEST_CASE("layer images are printed at the height they were sliced at") {
    const pliant::test::Folder folder("stacks");
    CHECK(layer_or_error("", stacks(folder, "0.1")) == "100");  // not the printer's 50
    CHECK(layer_or_error("100 um", stacks(folder, "0.1")) == "100");
    CHECK(layer_or_error("0.1 mm", stacks(folder, "0.1", "0.100")) == "100");
    CHECK(layer_or_error("", stacks(folder, "", "0.025")) == "25");  // given by one of them
    CHECK(layer_or_error("50 um", stacks(folder, "0.1")) ==
          "--layer 50 um: the layer images are for layers of 100 um, the part would come out 0.5 times as high: leave "
          "--layer out, or slice again");
    CHECK(layer_or_error("", stacks(folder, "0.1", "0.05")) ==
          "images of \"soft\" are for layers of 100 um, those of \"firm\" for 50 um: slice them in the same layer "
          "height");
    CHECK(layer_or_error("", stacks(folder, "0.0125")).find("layer images are for layers of 12.5 um") == 0);
    CHECK(layer_or_error("", stacks(folder, "1.5")).find("layer images are for layers of 1500 um") == 0);
}

TEST_CASE("the first of the layer images is printed at the height that it was sliced at") {
    const pliant::test::Folder folder("first_layer");
    const auto tops = [&](const std::string& first_mm) -> Result<std::vector<int>> {
        const std::filesystem::path at = folder / first_mm;
        write_stack(at, "0.05");
        REQUIRE(write_file(at / "prusaslicer.ini", "layer_height = 0.05\ninitial_layer_height = " + first_mm + "\n"));
        Progress silent;
        Drawing drawing = read_drawing({"soft=" + at.string()}, {}, silent).value();
        const auto settings = job_settings(Order{}, printer(), {}, drawing);
        if (!settings) return tl::unexpected(settings.error());
        const slice::Layers layers = settings->slicing.layers();
        return std::vector<int>{layers.top_um(0), layers.top_um(1), layers.top_um(2)};
    };
    CHECK(tops("0.3").value() == std::vector<int>{300, 350, 400});
    CHECK(tops("0.05").value() == std::vector<int>{50, 100, 150});
    CHECK(tops("0.0125").error().message ==
          "the first layer of \"soft\" is 12.5 um high: a whole number of micrometres from 1 to 1000 is needed");
}

TEST_CASE("layer images for pixels of another size are refused") {
    const pliant::test::Folder folder("stack_pixels");
    const auto with = [&](double x_mm, double y_mm) {
        const std::filesystem::path at = folder / fmt::format("{}_{}", x_mm, y_mm);
        write_stack(at, "");
        REQUIRE(write_file(at / "slicer.json",
                           fmt::format(R"({{"Thickness": 50, "XPixelSize": {}, "YPixelSize": {}}})", x_mm, y_mm)));
        Progress silent;
        return layer_or_error("", read_drawing({"soft=" + at.string()}, {}, silent).value());
    };
    CHECK(with(0.1, 0.1) == "50");
    CHECK(with(0.1004, 0.0996) == "50");  // rounded by the other program
    CHECK(
        with(0.05, 0.05) ==
        "images of \"soft\" are for pixels of 50 x 50 um, the projector has 100 um: the part would come out 2 times as "
        "wide; slice it for this printer");
    CHECK(with(0.1, 0.125).find("0.8 times as deep") != std::string::npos);
}

TEST_CASE("options that would change layer images are refused") {
    const pliant::test::Folder folder("stack_options");
    const std::pair<const char*, Change> options[] = {
        {"--spacing", [](Order& o) { o.spacing = "3 mm"; }},
        {"--support-angle", [](Order& o) { o.support_angle = "45 deg"; }},
        {"--support-spacing", [](Order& o) { o.support_spacing = "3 mm"; }},
        {"--support-tip", [](Order& o) { o.support_tip = "0.4 mm"; }},
        {"--support-pillar", [](Order& o) { o.support_pillar = "1 mm"; }},
        {"--support-paint", [](Order& o) { o.support_paint = "table"; }},
        {"--lift", [](Order& o) { o.lift = "5 mm"; }},
        {"--raft", [](Order& o) { o.raft = "1 mm"; }},
        {"--drain", [](Order& o) { o.drain = "3 mm"; }},
        {"--no-anti-alias", [](Order& o) { o.no_anti_alias = true; }},
        {"--threshold", [](Order& o) { o.threshold = 0.3; }}};
    for (const auto& [option, change] : options) {
        Order order;
        change(order);
        Drawing drawing = stacks(folder, "0.05");
        const auto settings = job_settings(order, printer(), {}, drawing);
        REQUIRE(!settings.has_value());
        CHECK(settings.error().message == std::string(option) + ": layer images are printed as they are");
    }
}

TEST_CASE("a name with a line break stays out of the job") {
    Drawing drawing = two_blocks();
    drawing.name = "rob\nM42 P4 S255\n;";
    CHECK(settings_of([](Order&) {}, std::move(drawing)).name == "rob M42 P4 S255 ;");
    drawing = two_blocks();
    drawing.bodies[0].material = "so\nft";
    drawing.resin_of_material[0] = {"so\nft", "soft"};
    Order order;
    CHECK(job_settings(order, printer(), {}, drawing).error().message ==
          "material \"so ft\": a name must have no line breaks or other control characters");
}

TEST_CASE("images without a layer height take --layer, or the printer's with a warning") {
    const pliant::test::Folder folder("stacks");
    CHECK(layer_or_error("100 um", stacks(folder, "")) == "100");
    CHECK(layer_or_error("", stacks(folder, "")) == "50 assumed");
}

TEST_CASE("options that are not given take the printer's values") {
    const job::JobSettings s = settings_of([](Order&) {});
    CHECK(s.name == "blocks");
    CHECK(s.slicing.layer_um == 50);
    CHECK(s.slicing.raster.width_px == 200);
    CHECK(s.slicing.raster.pixel_um == 100);
    CHECK(s.slicing.rules.anti_alias);
    CHECK(s.bottom_layers == 3);
    CHECK(s.least_feature_um == 0);
    CHECK(s.copies == 1);
    REQUIRE(s.materials.size() == 2);
    CHECK(s.materials[0].exposure_s == 2);
    CHECK(s.materials[0].bottom_exposure_s == 9);
    CHECK(s.materials[1].exposure_s == 4);
    CHECK(s.slicing.teeth.empty());
    CHECK(s.slicing.bonds.empty());
    CHECK(s.exposures.empty());
}

TEST_CASE("every resin's own bottom layers count, and those of resins that are not used do not") {
    machine::Printer p = printer();
    p.resins[1].transition_layers = 2;
    machine::Resin unused;
    unused.name = "unused";
    unused.exposure_s = unused.bottom_exposure_s = 1;
    unused.bottom_layers = 8;
    p.resins.push_back(unused);
    Drawing drawing = two_blocks();
    auto s = job_settings({}, p, {}, drawing);
    REQUIRE(s.has_value());
    const auto layers = [&](std::size_t m) { return s->materials[m].bottom_layers.value_or(s->bottom_layers); };
    CHECK(layers(0) == 3);
    CHECK(layers(1) == 2);
    CHECK(s->exposures.at("firm").bottom_layers == 2);
    Order order;
    order.exposures = {"soft:7=1 s"};
    drawing = two_blocks();
    s = job_settings(order, p, {}, drawing);
    REQUIRE(s.has_value());
    CHECK(s->exposures.at("soft").bottom_layers == 3);
    drawing = two_blocks();
    drawing.bodies.pop_back();
    drawing.resin_of_material.pop_back();
    drawing.resin_of_material[0].second = "firm";
    s = job_settings({}, p, {}, drawing);
    REQUIRE(s.has_value());
    CHECK(layers(0) == 2);
}

TEST_CASE("--layer and --least-feature set their values") {
    CHECK(settings_of([](Order& o) { o.layer = "25 um"; }).slicing.layer_um == 25);
    CHECK(settings_of([](Order& o) { o.least_feature = "0.3 mm"; }).least_feature_um == near(300, {.relative = 1e-12}));
    CHECK(settings_of([](Order& o) { o.least_feature = "10 mm"; }).least_feature_um ==
          near(10000, {.relative = 1e-12}));
    CHECK(refused_settings([](Order& o) { o.layer = "0.5 um"; }).find("--layer 0.5 um: a whole number") == 0);
    CHECK(refused_settings([](Order& o) { o.layer = "50"; }).find("--layer: ") == 0);
    CHECK(refused_settings([](Order& o) { o.least_feature = "10.1 mm"; }) ==
          "--least-feature 10.1 mm: must be 1e-06 to 10 mm");
    CHECK(refused_settings([](Order& o) { o.least_feature = "0 mm"; }).find("--least-feature 0 mm: must be") == 0);
    CHECK(settings_of([](Order& o) { o.least_feature = "0.2 mm"; }).least_feature_um == near(200, {.relative = 1e-12}));
    CHECK(refused_settings([](Order& o) { o.least_feature = "0.199 mm"; }) ==
          "--least-feature 0.199 mm: must be 0.2 to 10 mm, at least two pixels of 100 um");
}

TEST_CASE("--interlock and --overlap name two materials, pixels and layers") {
    const auto s = settings_of([](Order& o) {
        o.interlocks = {"soft+firm=4", "firm+soft=3,2"};
        o.overlaps = {"soft+firm=2", "soft+firm=0,1"};
    });
    REQUIRE(s.slicing.teeth.size() == 2);
    CHECK(s.slicing.teeth[0].first == "soft");
    CHECK(s.slicing.teeth[0].second == "firm");
    CHECK(s.slicing.teeth[0].depth_px == 4);
    CHECK(s.slicing.teeth[0].layers == 1);
    CHECK(s.slicing.teeth[1].layers == 2);
    REQUIRE(s.slicing.bonds.size() == 2);
    CHECK(s.slicing.bonds[0].depth_px == 2);
    CHECK(s.slicing.bonds[0].layers == 0);
    CHECK(s.slicing.bonds[1].depth_px == 0);
    CHECK(s.slicing.bonds[1].layers == 1);
    for (const char* wrong : {"soft=4", "soft+firm", "soft=4+firm", ""})
        CHECK(refused_settings([&](Order& o) { o.interlocks = {wrong}; }).find("write MATERIAL+MATERIAL=PIXELS") !=
              std::string::npos);
    for (const char* wrong : {"soft+firm=", "soft+firm=-1", "soft+firm=2,", "soft+firm=2,x", "soft+firm=1.5"})
        CHECK(refused_settings([&](Order& o) { o.overlaps = {wrong}; }).find("must be whole numbers") !=
              std::string::npos);
}

TEST_CASE("--exposure sets all layers of a material, its first layers, or some layers") {
    auto s = settings_of([](Order& o) { o.exposures = {"soft=3 s"}; });
    CHECK(s.materials[0].exposure_s == 3);
    CHECK(s.materials[0].bottom_exposure_s == 9);  // still the longer one
    CHECK(s.materials[1].exposure_s == 4);
    s = settings_of([](Order& o) { o.exposures = {"soft=20 s"}; });
    CHECK(s.materials[0].bottom_exposure_s == 20);
    s = settings_of([](Order& o) { o.exposures = {"soft=1.6 ms,20.0004 s"}; });
    CHECK(s.materials[0].exposure_s == 0.002);  // as the program says it
    CHECK(s.materials[0].bottom_exposure_s == 20);
    s = settings_of([](Order& o) { o.exposures = {"soft=20 s,5 s"}; });
    CHECK(s.materials[0].bottom_exposure_s == 5);
    s = settings_of([](Order& o) { o.exposures = {"firm:2-5=6 s", "firm:7=1 s"}; });
    REQUIRE(s.exposures.contains("firm"));
    const auto& spans = s.exposures.at("firm").spans;
    REQUIRE(spans.size() == 2);
    CHECK(spans[0].first == 2);
    CHECK(spans[0].last == 5);
    CHECK(spans[0].seconds == 6);
    CHECK(spans[1].first == 7);
    CHECK(spans[1].last == 7);
    CHECK(s.materials[1].exposure_s == 4);
    CHECK(settings_of([](Order& o) { o.exposures = {"soft=1 h"}; }).materials[0].exposure_s == 3600);
    for (const char* wrong : {"soft", "=3 s", ""})
        CHECK(refused_settings([&](Order& o) { o.exposures = {wrong}; }).find("write MATERIAL=TIME") !=
              std::string::npos);
    for (const char* wrong : {"soft=0 s", "soft=-1 s", "soft=3601 s", "soft=2 s,0 s"})
        CHECK(refused_settings([&](Order& o) {
                  o.exposures = {wrong};
              }).find("must be from a millisecond to an hour") != std::string::npos);
    for (const char* wrong : {"soft:5-2=3 s", "soft:-1-2=3 s", "soft:=3 s", "soft:1-=3 s", "soft:1-2=3 s,4 s"})
        CHECK(refused_settings([&](Order& o) { o.exposures = {wrong}; }).find("layers are FIRST-LAST") !=
              std::string::npos);
    for (const char* wrong : {"soft=61 s", "soft=3 s,61 s", "soft:2-4=61 s"}) {
        Order order;
        order.exposures = {wrong};
        Drawing drawing = two_blocks();
        machine::Printer limited = printer();
        limited.name = "small";
        limited.limits.exposure_s = 60;
        const auto refused = job_settings(order, limited, {}, drawing);
        REQUIRE(!refused.has_value());
        CHECK(refused.error().message ==
              fmt::format("--exposure {}: 61 s for \"soft\", the limit of small is 60 s", wrong));
    }
    CHECK(refused_settings([](Order& o) { o.exposures = {"hard=3 s"}; }).find("there is no material \"hard\"") !=
          std::string::npos);
    CHECK(refused_settings([](Order& o) { o.exposures = {"soft=3 mm"}; }).find("--exposure soft=3 mm: ") == 0);
}

TEST_CASE("an exposure far from the printer file's gives a warning with its cure depth") {
    machine::Printer p = printer();
    p.resins[0].cure_depth_um = 150;
    p.resins[0].critical_share = 0.2;
    const auto warnings = [&](const char* exposure) {
        Drawing drawing = two_blocks();
        Order order;
        order.exposures = {exposure};
        REQUIRE(job_settings(order, p, {}, drawing).has_value());
        return drawing.warnings;
    };
    CHECK(warnings("soft=1 s").empty());
    CHECK(warnings("soft=4 s").empty());
    REQUIRE(warnings("soft=0.3 s").size() == 1);
    CHECK(warnings("soft=0.3 s")[0].starts_with(
        "--exposure soft=0.3 s: 0.3 s is 0.15 times the 2 s that the printer file "
        "gives resin \"soft\"; it cures 32.1 um deep, layers are 50 um"));
    CHECK(warnings("soft=20 s").size() == 1);
    CHECK(warnings("soft=2 s,100 s").size() == 1);
    CHECK(warnings("soft:2-4=20 s").size() == 1);
    CHECK(warnings("soft:0-2=9 s").empty());
    CHECK(warnings("soft:0-3=2 s").empty());
    CHECK(warnings("soft:3-9=9 s").size() == 1);
    REQUIRE(warnings("soft:0-2=2 s").size() == 1);
    CHECK(warnings("soft:0-2=2 s")[0].starts_with("--exposure soft:0-2=2 s: 2 s is 0.222 times the 9 s that"));
    CHECK(warnings("firm=20 s") == std::vector<std::string>{"--exposure firm=20 s: 20 s is 5 times the 4 s that the "
                                                            "printer file gives resin \"firm\""});
}

TEST_CASE("--resin sets resin and exposures; one that no vat holds is an error unless any vat may be used") {
    Drawing drawing = two_blocks();
    Order order;
    order.resins = {"soft=firm"};
    auto s = job_settings(order, printer(), {}, drawing);
    REQUIRE(s.has_value());
    CHECK(s->materials[0].resin == "firm");
    CHECK(s->materials[0].exposure_s == 4);
    CHECK(drawing.warnings.empty());
    CHECK(refused_settings([](Order& o) { o.resins = {"soft=frim"}; }).find("did you mean \"firm\"?") !=
          std::string::npos);
    const std::string unknown = refused_settings([](Order& o) { o.resins = {"soft=glue"}; });
    CHECK(unknown.find("no vat of  holds the resin \"glue\" of \"soft\": they hold soft and firm.") == 0);
    CHECK(unknown.find("--any-vat") != std::string::npos);
    drawing = two_blocks();
    order.resins = {"soft=glue"};
    order.any_vat = true;
    s = job_settings(order, printer(), {}, drawing);
    REQUIRE(s.has_value());
    CHECK(s->any_vat);
    CHECK(s->materials[0].exposure_s == 4);  // the longest known one
    CHECK(s->materials[0].bottom_exposure_s == 9);
    REQUIRE(drawing.warnings.size() == 1);
    CHECK(drawing.warnings[0].find("resin \"glue\" is not in the printer file") == 0);
    // Adaptive layers: the virtual printer, too, assumes that light fades by a factor of e in a layer of it.
    CHECK(s->exposures.empty());
    order.least_layer = "20 um";
    drawing = two_blocks();
    s = job_settings(order, printer(), {}, drawing);
    REQUIRE(s.has_value());
    const job::ExposureRule& glue = s->exposures.at("soft");
    CHECK(glue.penetration_um == printer().layer_um);
    CHECK(glue.bottom_layers == s->bottom_layers);
    CHECK(refused_settings([](Order& o) { o.resins = {"hard=firm"}; }).find("hard") != std::string::npos);
    CHECK(!refused_settings([](Order& o) { o.resins = {"soft"}; }).empty());
}

TEST_CASE("what is said of a material holds for its bodies with exposures of their own, unless these are named") {
    const auto drawn = [] {
        Drawing d = two_blocks();
        d.bodies.push_back({"soft of lid", box_um({18000, 0, 5000}, {19000, 4000, 8000}), "lid"});
        d.resin_of_material.insert(d.resin_of_material.begin(), {"soft of lid", "soft"});
        d.exposure_of_material["soft of lid"] = {7, 0};
        d.made_of["soft of lid"] = "soft";
        return d;
    };
    const auto settings = [&](Drawing& drawing, const Change& change) {
        Order order;
        change(order);
        auto made = job_settings(order, printer(), {}, drawing);
        REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
        return std::move(*made);
    };
    Drawing drawing = drawn();
    auto s = settings(drawing, [](Order& o) { o.resins = {"soft=firm"}; });
    for (const job::Material& m : s.materials) CHECK(m.resin == "firm");
    drawing = drawn();
    s = settings(drawing, [](Order& o) { o.resins = {"soft=firm", "soft of lid=soft"}; });
    CHECK(s.materials[0].resin == "soft");
    CHECK(s.materials[1].resin == "firm");
    drawing = drawn();
    s = settings(drawing, [](Order& o) {
        o.overlaps = {"soft+firm=2"};
        o.interlocks = {"firm+soft=3,2", "firm+soft of lid=1", "soft+soft of lid=4"};
    });
    const auto pairs = [](const auto& all) {
        std::vector<std::string> texts;
        for (const auto& p : all) texts.push_back(fmt::format("{}+{}={},{}", p.first, p.second, p.depth_px, p.layers));
        return texts;
    };
    CHECK(pairs(s.slicing.bonds) == std::vector<std::string>{"soft+firm=2,0", "soft of lid+firm=2,0"});
    CHECK(pairs(s.slicing.teeth) ==
          std::vector<std::string>{"firm+soft=3,2", "firm+soft of lid=1,1", "soft+soft of lid=4,1"});
    // Its own exposure is said of the body: the material's leaves it, and the warning says so.
    drawing = drawn();
    s = settings(drawing, [](Order& o) { o.exposures = {"soft=3 s"}; });
    CHECK(s.materials[0].exposure_s == 7);
    CHECK(s.materials[1].exposure_s == 3);
    REQUIRE(drawing.warnings.size() == 1);
    CHECK(drawing.warnings[0] ==
          "--exposure soft: \"soft of lid\" keeps the exposure that the robot file gives its body; "
          "--exposure \"soft of lid=TIME\" sets it");
    drawing = drawn();
    s = settings(drawing, [](Order& o) { o.exposures = {"soft=3 s", "soft of lid=4 s"}; });
    CHECK(s.materials[0].exposure_s == 4);
    CHECK(drawing.warnings.empty());
}

TEST_CASE("the resins' settings in the printer file reach their materials") {
    machine::Printer p = printer();
    p.resins[1].xy_compensation_um = -40;
    p.resins[0].transition_layers = 5;
    p.projector.grey = {0, 0.5, 1};
    Drawing drawing = two_blocks();
    const auto s = job_settings({}, p, {}, drawing);
    REQUIRE(s.has_value());
    REQUIRE(s->slicing.compensation.size() == 1);
    CHECK(s->slicing.compensation.at("firm").grow_um == -40);
    REQUIRE(s->exposures.size() == 1);
    CHECK(s->exposures.at("soft").transition_layers == 5);
    CHECK(s->exposures.at("soft").bottom_layers == 3);
    CHECK(!s->light.none());
}

TEST_CASE("--support with a material of no body takes the resin of that name; the record keeps the option") {
    Order order;
    order.support = "firm";
    Drawing drawing = two_blocks();
    REQUIRE(job_settings(order, printer(), {}, drawing).has_value());
    CHECK(drawing.resin_of_material.size() == 2);
    order.support = "brittle";
    order.raft = "1 mm";
    drawing = two_blocks();
    const auto unknown = job_settings(order, printer(), {}, drawing);
    REQUIRE(!unknown.has_value());
    CHECK(unknown.error().message ==
          "--support brittle: is neither a material of the part nor a resin of the printer (soft and firm); or say "
          "--resin brittle=RESIN");
    drawing = two_blocks();
    order.resins = {"brittle=firm"};
    const auto s = job_settings(order, printer(), {}, drawing);
    REQUIRE(s.has_value());
    CHECK(s->materials.size() == 3);
    CHECK(s->materials[2].resin == "firm");
    const job::Request request = request_of(order, *s);
    REQUIRE(request.supports.size() == 2);
    CHECK(request.supports[0] == std::pair<std::string, std::string>{"support", "brittle"});
    CHECK(request.supports[1] == std::pair<std::string, std::string>{"raft", "1 mm"});
}

TEST_CASE("--no-anti-alias and --threshold set the slicing rules") {
    const auto s = settings_of([](Order& o) {
        o.no_anti_alias = true;
        o.threshold = 0.3;
    });
    CHECK(!s.slicing.rules.anti_alias);
    CHECK(s.slicing.rules.threshold == 0.3);
}

TEST_CASE("a job is named .zip, and is neither an input nor the printer file") {
    const pliant::test::Folder folder("job_name");
    const std::string stack = (folder / "stack.zip").string(), printer = (folder / "p.zip").string();
    REQUIRE(write_file(stack, "x"));
    REQUIRE(write_file(printer, "x"));
    CHECK(check_job_name(folder / "r.zip", {"soft=" + stack}, printer));
    CHECK(check_job_name("r.toml", {"r.toml"}, printer).error().message == "r.toml: a job ends in .zip, as in r.zip");
    CHECK(check_job_name(stack, {"soft=" + stack}, printer).error().message ==
          stack + ": is an input, which the job would replace; give it another name");
    CHECK(check_job_name(printer, {"soft=" + stack}, printer).error().message ==
          printer + ": is the printer file, which the job would replace; give it another name");
}

TEST_CASE("an exposure of the robot file over the printer's limit names the material, or the material of the body") {
    Drawing drawing = two_blocks();
    drawing.exposure_of_material["soft"] = {61, 0};
    machine::Printer limited = printer();
    limited.name = "tower";
    limited.limits.exposure_s = 60;
    const Result<job::JobSettings> refused = job_settings(Order{}, limited, {}, drawing);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message == "material \"soft\": exposure of 61 s, the limit of tower is 60 s");
    drawing.exposure_of_material["soft"] = {60, 0};
    CHECK(job_settings(Order{}, limited, {}, drawing));
}
