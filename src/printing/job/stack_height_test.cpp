#include "printing/job/stack_height.hpp"

#include <doctest/doctest.h>

#include <map>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::job;

namespace {

using Files = std::map<std::string, std::string>;

Result<std::optional<double>> height(const Files& files) {
    std::vector<std::string> names;
    for (const auto& [name, text] : files) names.push_back(name);
    return stated_layer_um(names, [&](const std::string& name) -> Result<std::string> { return files.at(name); });
}

double um(const Files& files) {
    const auto found = height(files);
    REQUIRE_MESSAGE(found, (found ? "" : found.error().message));
    return found->value_or(-1);
}

std::string refused_height(const Files& files) {
    const auto found = height(files);
    REQUIRE_FALSE(found);
    return found.error().message;
}

}  // namespace

TEST_CASE("the layer height is read from every format, with its own key and unit") {
    CHECK(um({{"config.ini", "action = print\r\nlayerHeight = 0.05\r\n"}}) == near(50, {.relative = 1e-12}));
    CHECK(um({{"prusaslicer.ini", "initial_layer_height = 0.1\nlayer_height=0.025\n"}}) ==
          near(25, {.relative = 1e-12}));
    CHECK(um({{"slicer.json", R"({"Thickness": 100, "PWidth": 3})"}}) == near(100, {.relative = 1e-12}));
    CHECK(um({{"profile.json", R"({"Depth": "35"})"}, {"slicer.json", "{}"}}) == near(35, {.relative = 1e-12}));
    CHECK(um({{"slice.conf", "# Nova\nthickness = 0.035  # mm\n"}}) == near(35, {.relative = 1e-12}));
    CHECK(um({{"part.slicing",
               "<SliceBuildConfig><InkConfig><SliceHeight>0.05</SliceHeight></InkConfig>"
               "<InkConfig><SliceHeight> 0.050 </SliceHeight></InkConfig></SliceBuildConfig>"}}) ==
          near(50, {.relative = 1e-12}));
    CHECK(um({{"manifest.uvtools", "<Manifest><LayerHeight>0.1</LayerHeight></Manifest>"}}) ==
          near(100, {.relative = 1e-12}));
    // config.ini takes precedence, as on the printer.
    CHECK(um({{"config.ini", "layerHeight = 0.1"}, {"prusaslicer.ini", "layer_height = 0.05"}}) ==
          near(100, {.relative = 1e-12}));
    CHECK(um({{"config.ini", "nothing"}, {"prusaslicer.ini", "layer_height = 0.05"}}) == near(50, {.relative = 1e-12}));
}

TEST_CASE("the first layer has its own height where PrusaSlicer says so") {
    const auto first = [](const Files& files) {
        std::vector<std::string> names;
        for (const auto& [name, text] : files) names.push_back(name);
        return stated_first_layer_um(names,
                                     [&](const std::string& name) -> Result<std::string> { return files.at(name); });
    };
    CHECK(first({{"prusaslicer.ini", "initial_layer_height = 0.1\nlayer_height=0.025\n"}})->value() ==
          near(100, {.relative = 1e-12}));
    CHECK_FALSE(first({{"prusaslicer.ini", "layer_height = 0.05\n"}})->has_value());
    CHECK_FALSE(first({{"config.ini", "layerHeight = 0.05\ninitial_layer_height = 0.1\n"}})->has_value());
    CHECK(first({{"prusaslicer.ini", "initial_layer_height = thick\n"}}).error().message ==
          "prusaslicer.ini: initial_layer_height = \"thick\": a layer height above 0 and below 10 mm is needed");
}

TEST_CASE("files without a layer height give none") {
    CHECK(um({}) == -1);
    CHECK(um({{"old_config.ini", "layerHeight = 0.05"}}) == -1);
    CHECK(um({{"slicer.json", "{ broken"}}) == -1);
    CHECK(um({{"slicer.json", "[1, 2]"}}) == -1);
    CHECK(um({{"config.ini", std::string("\0\xff=\n==\n", 7)}}) == -1);
}

TEST_CASE("an invalid layer height is an error that names file and key") {
    CHECK(refused_height({{"config.ini", "layerHeight = thin"}}) ==
          "config.ini: layerHeight = \"thin\": a layer height above 0 and below 10 mm is needed");
    for (const char* value : {"0", "-0.05", "nan", "inf", "10", "0.05mm", ""})
        CHECK(refused_height({{"config.ini", std::string("layerHeight = ") + value}}).find("config.ini: layerHeight") ==
              0);
    CHECK(refused_height({{"slicer.json", R"({"Thickness": null})"}}).find("slicer.json: Thickness") == 0);
    CHECK(refused_height({{"a.slicing", "<SliceHeight>0.05</SliceHeight><SliceHeight>0.1</SliceHeight>"}}) ==
          "a.slicing: SliceHeight is 50 um and 100 um: layers of one height are needed");
}

TEST_CASE("the size of a pixel is read from every format that states display or pixels") {
    const auto pixel = [](const Files& files) {
        std::vector<std::string> names;
        for (const auto& [name, text] : files) names.push_back(name);
        return stated_pixel(names, [&](const std::string& name) -> Result<std::string> { return files.at(name); })
            .value()
            .value_or(PixelSize{});
    };
    const auto is = [](const PixelSize& p, double x_um, double y_um) {
        return p.x_um == near(x_um, {.relative = 1e-12}) && p.y_um == near(y_um, {.relative = 1e-12});
    };
    CHECK(is(pixel({{"prusaslicer.ini",
                     "display_height = 67.5\ndisplay_pixels_x = 2560\ndisplay_pixels_y = 1440\n"
                     "display_width = 120\n"}}),
             46.875, 46.875));
    CHECK(is(pixel({{"slicer.json", R"({"XPixelSize": 0.05, "YPixelSize": 0.06})"}}), 50, 60));
    CHECK(is(pixel({{"a.slicing", "<DotsPermmX>20</DotsPermmX><DotsPermmY>25</DotsPermmY>"}}), 50, 40));
    CHECK(is(pixel({{"manifest.uvtools",
                     "<ResolutionX>100</ResolutionX><ResolutionY>50</ResolutionY>"
                     "<DisplayWidth>10</DisplayWidth><DisplayHeight>5</DisplayHeight>"}}),
             100, 100));
    // Zeros, lists and what is missing state nothing.
    CHECK(is(pixel({{"manifest.uvtools",
                     "<ResolutionX>100</ResolutionX><ResolutionY>50</ResolutionY>"
                     "<DisplayWidth>0</DisplayWidth><DisplayHeight>0</DisplayHeight>"}}),
             0, 0));
    CHECK(is(pixel({{"slicer.json", "[1]"}, {"config.ini", "layerHeight = 0.1"}}), 0, 0));
    CHECK(is(pixel({{"prusaslicer.ini", "display_width = wide\ndisplay_pixels_x = 0\n"}}), 0, 0));
}
