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
