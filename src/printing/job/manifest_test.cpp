#include "printing/job/manifest.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/test_text.hpp"

using namespace pliant;
using namespace pliant::job;
using pliant::test::replaced;

namespace {

Manifest example() {
    return {"finger",
            "0.1.0",
            64,
            48,
            100.5,
            2,
            {{"soft", "semi-flex", 12.5, 30.25, 6, 30}, {"rigid é \"x\"", "hard", 1, 2, 3.5, 4}},
            {{50, 50, {{0, "layers/00000_soft.png", 1.5}, {1, "layers/00000_rigid.png", 0.1}}}, {100, 50, {}}},
            {"one", "two"}};
}

void refuse(const Manifest& manifest, std::string_view part) {
    const auto status = check(manifest, "job.zip");
    REQUIRE(!status.has_value());
    CAPTURE(status.error().message);
    CHECK(status.error().message.find("job.zip: ") == 0);
    CHECK(status.error().message.find(part) != std::string::npos);
    CHECK(!manifest_from_json(to_json(manifest), "job.zip").has_value());
}

std::string refused_json(const std::string& json) {
    const auto manifest = manifest_from_json(json, "job.zip: manifest.json");
    REQUIRE(!manifest.has_value());
    CHECK(manifest.error().message.find("job.zip: manifest.json: ") == 0);
    return manifest.error().message;
}

}  // namespace

TEST_CASE("a manifest is read back as written") {
    const Manifest m = example();
    const auto back = manifest_from_json(to_json(m), "x");
    REQUIRE(back.has_value());
    CHECK(to_json(*back) == to_json(m));
    CHECK(back->materials[1].name == m.materials[1].name);
    CHECK(back->pixel_um == 100.5);
    CHECK(back->bottom_layers == 2);
    CHECK(back->materials[0].model_area_mm2 == 30.25);
    CHECK(back->materials[0].bottom_exposure_s == 30);
    CHECK(back->layers[0].images[1].file == "layers/00000_rigid.png");
    CHECK(back->layers[1].z_um == 100);
    CHECK(back->layers[1].images.empty());
    CHECK(back->warnings == m.warnings);
}

TEST_CASE("a material's colour is read back as written, and only where there is one") {
    Manifest m = example();
    CHECK(to_json(m).find("colour") == std::string::npos);
    m.materials[1].colour = "#1a2B3c";
    const auto back = manifest_from_json(to_json(m), "x");
    REQUIRE(back.has_value());
    CHECK(back->materials[0].colour.empty());
    CHECK(back->materials[1].colour == "#1a2B3c");
    for (const char* wrong : {"red", "#12345", "#12345g", "1a2b3c#", "#1a2b3c "}) {
        m.materials[1].colour = wrong;
        refuse(m, "materials[1].colour");
    }
}

TEST_CASE("a material's own number of bottom layers counts for it alone; others have that of the job") {
    Manifest m = example();
    m.layers[1].images = {{0, "layers/00001_soft.png", 1.5}, {1, "layers/00001_rigid.png", 0.1}};
    CHECK(to_json(m).find("bottom_layers") == to_json(m).rfind("bottom_layers"));
    m.materials[1].bottom_layers = 1;
    const auto back = manifest_from_json(to_json(m), "x");
    REQUIRE(back.has_value());
    CHECK(!back->materials[0].bottom_layers);
    CHECK(back->materials[1].bottom_layers == 1);
    CHECK(exposure_s(*back, 1, 0) == 30);
    CHECK(exposure_s(*back, 0, 1) == 4);
    CHECK(exposure_s(*back, 1, 1) == 3.5);
    m.materials[1].bottom_layers = -1;
    refuse(m, "materials[1].bottom_layers: -1 must be 0 or more");
}

TEST_CASE("an inconsistent manifest is refused") {
    Manifest m = example();
    m.width_px = 0;
    refuse(m, "width_px");
    m = example();
    m.width_px = m.height_px = 65535;
    refuse(m, "2^28");
    m = example();
    m.pixel_um = 0;
    refuse(m, "pixel_um");
    m = example();
    m.bottom_layers = -1;
    refuse(m, "bottom_layers");
    m = example();
    m.materials[1].name = "soft";
    refuse(m, "materials[1].name: 'soft' is named twice");
    m = example();
    m.materials[0].name = "";
    refuse(m, "materials[0].name");
    m = example();
    m.materials[0].parts = {{"a", 12.5, 30.25}};
    refuse(m, "materials[0].parts: has one entry; it lists two or more materials");
    m = example();
    m.materials[1].exposure_s = -1;
    refuse(m, "materials[1].exposure_s");
    m = example();
    m.materials[1].model_volume_mm3 = std::nan("");
    refuse(m, "materials[1].model_volume_mm3");
    m = example();
    m.layers[1].z_um = 50;
    refuse(m, "layers[1].z_um: 50 must be above the layer before, 50");
    m = example();
    m.layers[0].thickness_um = 51;
    refuse(m, "layers[0].thickness_um");
    m = example();
    m.layers[0].images[1].material = 2;
    refuse(m, "layers[0].images[1].material: 2 is not one of the 2");
    m.layers[0].images[1].material = -1;
    refuse(m, "layers[0].images[1].material");
    m.layers[0].images[1].material = 0;
    refuse(m, "each material comes once");
    m = example();
    m.layers[0].images[0].file = "../x.png";
    refuse(m, "layers[0].images[0].file");
    m = example();
    m.layers[0].images[0].area_mm2 = -0.5;
    refuse(m, "area_mm2");
}

TEST_CASE("a thickness other than the step of z_um, and names with control characters are refused") {
    Manifest m = example();
    m.layers[1].thickness_um = 40;
    refuse(m, "layers[1].thickness_um: 40 must be the step of z_um, 50");
    m = example();
    m.name = "a\nM42 P4 S255";
    refuse(m, "name: has a line break");
    m = example();
    m.materials[1].name = "a\x1b[2J";
    refuse(m, "materials[1]: name or resin has a line break");
    m = example();
    m.materials[0].resin = "soft\r";
    refuse(m, "materials[0]: name or resin has a line break");
}

TEST_CASE("JSON of another shape is refused with the key") {
    const std::string good = to_json(example());
    CHECK(refused_json("").find("is not JSON: an error at line 1, column 1") != std::string::npos);
    CHECK(refused_json(good.substr(0, good.size() / 2)).find("line") != std::string::npos);
    CHECK(refused_json("[]").find("an object is needed") != std::string::npos);
    CHECK(refused_json("3").find("an object is needed") != std::string::npos);
    CHECK(refused_json(replaced(good, "\"format\": 1", "\"format\": 3")).find("only formats 1 and 2") !=
          std::string::npos);
    CHECK(refused_json(replaced(good, "\"width_px\": 64", "\"width_px\": \"64\"")).find("width_px: a whole number") !=
          std::string::npos);
    CHECK(refused_json(replaced(good, "\"width_px\": 64", "\"width_px\": 6.4")).find("width_px: a whole number") !=
          std::string::npos);
    for (const char* huge : {"4294967360", "18446744073709551615", "-9223372036854775808", "1e99"})
        CHECK(refused_json(replaced(good, "\"width_px\": 64", std::string("\"width_px\": ") + huge)).find("width_px") !=
              std::string::npos);
    CHECK(refused_json(replaced(good, "\"exposure_s\": 6.0", "\"exposure_s\": null"))
              .find("materials[0].exposure_s: a number") != std::string::npos);
    CHECK(refused_json(replaced(good, "\"resin\": \"hard\"", "\"resin\": []")).find("materials[1].resin: a text") !=
          std::string::npos);
    CHECK(refused_json(replaced(good, "\"z_um\": 100,", "")).find("layers[1].z_um: is missing") != std::string::npos);
    CHECK(refused_json(replaced(good, "\"two\"", "2")).find("warnings[1]: a text") != std::string::npos);
    CHECK(refused_json(std::string(100000, '[')).size() < 500);
    CHECK(refused_json(std::string(50, '[') + std::string(50, ']')).find("nested deeper") != std::string::npos);
}

TEST_CASE("entry names: safe ones, unsafe ones and names of images") {
    for (const char* good : {"a", "layers/00012_soft.png", "a..b", "a b", "é/ü"}) CHECK(is_safe_entry_name(good));
    for (const char* bad : {"", "/a", "a/", "a//b", "..", "../a", "a/../b", "./a", "a\\b", "C:a", "a\nb"})
        CHECK(!is_safe_entry_name(bad));
    CHECK(!is_safe_entry_name(std::string(201, 'a')));
    CHECK(image_file_name(12, "soft") == "layers/00012_soft.png");
    CHECK(image_file_name(123456, "a b/../\xC3\xA9-1") == "layers/123456_a_b______-1.png");
}
