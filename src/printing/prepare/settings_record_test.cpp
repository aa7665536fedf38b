#include "printing/prepare/settings_record.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

using namespace pliant;
using namespace pliant::job;
using nlohmann::json;

TEST_CASE("the record holds the options given, and no folders") {
    JobSettings settings{"finger", "0.1.0", 2, {{64, 48, 100}, 50, {}}, {{"soft", "flex", 0, 0, 3, 9}}};
    settings.copies = 2;
    settings.least_feature_um = 300;
    settings.slicing.rules.anti_alias = false;
    settings.slicing.compensation["soft"] = {-40, 100, 3};
    settings.slicing.teeth = {{"soft", "rigid", 4, 2}};
    const std::vector<std::string> inputs{"soft=/home/me/a=b/finger.stl", "parts/base.3mf", "rigid=stack/",
                                          "./x=1/robot.toml"};
    const std::string text = settings_json(settings, {inputs, {"notches=3"}, {0, 90, 0}, "2 mm"});
    const json record = json::parse(text);
    CHECK(record["inputs"] == json{"soft=finger.stl", "base.3mf", "rigid=stack", "robot.toml"});
    CHECK(record["assignments"] == json{"notches=3"});
    CHECK(record["layer_um"] == 50);
    CHECK(record["raster"]["width_px"] == 64);
    CHECK(record["anti_alias"] == false);
    CHECK(record["turn_deg"] == json{0.0, 90.0, 0.0});
    CHECK(record["scale"] == 1);
    CHECK(record["at_mm"] == json{0.0, 0.0});
    CHECK(record["least_feature_um"] == 300);
    CHECK(record["materials"][0]["resin"] == "flex");
    CHECK(record["materials"][0]["xy_compensation_um"] == -40);
    CHECK(record["materials"][0]["elephant_foot_layers"] == 3);
    CHECK(record["interlock"][0]["materials"] == json{"soft", "rigid"});
    CHECK(record["interlock"][0]["depth_px"] == 4);
    CHECK(text == settings_json(settings, {inputs, {"notches=3"}, {0, 90, 0}, "2 mm"}));
}
