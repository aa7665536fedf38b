#include "presentation/report/gltf.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "base/core/near.hpp"
#include "presentation/report/test_robot.hpp"

using namespace pliant;
using namespace pliant::report;
using Json = nlohmann::json;

namespace {

std::uint32_t u32(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
}

struct Glb {
    Json document;
    std::string binary;

    [[nodiscard]] std::vector<float> floats(std::size_t accessor) const {
        const Json& view = document["bufferViews"][document["accessors"][accessor]["bufferView"].get<std::size_t>()];
        std::vector<float> values(view["byteLength"].get<std::size_t>() / 4);
        std::memcpy(values.data(), binary.data() + view["byteOffset"].get<std::size_t>(), 4 * values.size());
        return values;
    }
};

Glb parsed(const std::string& bytes) {
    REQUIRE(bytes.size() % 4 == 0);
    REQUIRE(bytes.substr(0, 4) == "glTF");
    CHECK(u32(bytes, 4) == 2);
    CHECK(u32(bytes, 8) == bytes.size());
    const std::size_t text = u32(bytes, 12), binary = u32(bytes, 20 + text);
    CHECK(bytes.substr(16, 4) == "JSON");
    CHECK(bytes.substr(24 + text, 4) == std::string("BIN\0", 4));
    CHECK(text % 4 == 0);
    REQUIRE(28 + text + binary == bytes.size());
    return {Json::parse(bytes.substr(20, text)), bytes.substr(28 + text)};
}

Glb glb_of(const report::test::Robot& robot, std::size_t targets) {
    const Simulation s = robot.simulation();
    return parsed(robot_glb(s, outer_surface(s.mesh, s.region_material), targets));
}

}  // namespace

TEST_CASE("buffer views are aligned and inside the buffer, and accessors keep their bounds") {
    const Glb glb = glb_of(report::test::bent_bar(10, 2), 40);
    CHECK(glb.document["buffers"][0]["byteLength"] == glb.binary.size());
    for (const Json& view : glb.document["bufferViews"]) {
        CHECK(view["byteOffset"].get<std::size_t>() % 4 == 0);
        CHECK(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>() <= glb.binary.size());
    }
    const Json& accessors = glb.document["accessors"];
    for (std::size_t a = 0; a < accessors.size(); ++a) {
        if (!accessors[a].contains("min")) continue;
        const auto values = glb.floats(a);
        const std::size_t width = accessors[a]["min"].size();
        CHECK(values.size() == width * accessors[a]["count"].get<std::size_t>());
        for (std::size_t i = 0; i < values.size(); ++i) {
            CHECK(values[i] >= accessors[a]["min"][i % width].get<float>());
            CHECK(values[i] <= accessors[a]["max"][i % width].get<float>());
        }
    }
}

TEST_CASE("there is a mesh per material in its colour, and a tube for the cable") {
    const Glb glb = glb_of(report::test::bent_bar(4, 1), 40);
    const Json& meshes = glb.document["meshes"];
    REQUIRE(meshes.size() == 3);
    for (std::size_t m = 0; m < 2; ++m) {
        CHECK(meshes[m]["name"] == glb.document["materials"][m]["name"]);
        REQUIRE(meshes[m]["primitives"].size() == 1);
        CHECK(meshes[m]["primitives"][0]["material"] == m);
        CHECK(meshes[m]["primitives"][0]["targets"].size() == 4);
        CHECK(meshes[m]["weights"].size() == 4);
    }
    CHECK(meshes[2]["name"] == "cables");
    CHECK(meshes[2]["primitives"].size() == 1);
    const Json& materials = glb.document["materials"];
    CHECK(materials[0]["name"] == "ninjaflex");
    CHECK(materials[1]["name"] == "cheetah");
    const Colour linear = to_linear(palette(1));
    CHECK(materials[1]["pbrMetallicRoughness"]["baseColorFactor"][0].get<double>() ==
          near(linear.r, {.relative = 1e-5}));
}

TEST_CASE("rest plus the last morph target equals the last step, with Y up") {
    const auto robot = report::test::bent_bar(4, 1);
    const Glb glb = glb_of(robot, 40);
    const Json& primitive = glb.document["meshes"][1]["primitives"][0];
    const auto rest = glb.floats(primitive["attributes"]["POSITION"].get<std::size_t>());
    const auto delta = glb.floats(primitive["targets"][3]["POSITION"].get<std::size_t>());
    REQUIRE(rest.size() == delta.size());
    double highest = 0, deepest = 0;
    for (std::size_t i = 0; i < rest.size(); i += 3) {
        highest = std::max<double>(highest, rest[i + 1] + delta[i + 1]);
        deepest = std::min<double>(deepest, rest[i + 2] + delta[i + 2]);
    }
    CHECK(highest == near(0.0075 + 0.2 / 3.14159265358979, {.relative = 1e-6}));  // the end of a quarter circle
    CHECK(deepest == near(-0.02, {.relative = 1e-5}));                            // Pliant's y runs into the picture
}

TEST_CASE("the animation shows the morph targets in order, in three seconds") {
    const Glb glb = glb_of(report::test::bent_bar(30, 1), 4);
    const Json& animation = glb.document["animations"][0];
    CHECK(animation["channels"].size() == 3);
    CHECK(animation["channels"][2]["target"] == Json({{"node", 2}, {"path", "weights"}}));
    const auto times = glb.floats(animation["samplers"][0]["input"].get<std::size_t>());
    const auto weights = glb.floats(animation["samplers"][0]["output"].get<std::size_t>());
    REQUIRE(times.size() == 5);
    CHECK(times.front() == 0);
    CHECK(times[1] == near(0.8F, {.relative = 1e-12}));  // step 8 of 30
    CHECK(times.back() == 3);
    CHECK(weights == std::vector<float>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
}

TEST_CASE("an obstacle is a mesh of its own, and its node moves") {
    const report::test::Robot robot = report::test::bent_bar(4, 1);
    Simulation s = robot.simulation();
    s.obstacles = {{"floor", disc({0, 0, -0.01}, {0, 0, 1}, 0.1), true, {}}};
    for (int i = 0; i <= 4; ++i) s.obstacles[0].offset_m.push_back({0.001 * i, 0.002 * i, 0.003 * i});
    const Glb glb = parsed(robot_glb(s, outer_surface(s.mesh, s.region_material), 40));
    REQUIRE(glb.document["meshes"].size() == 4);
    CHECK(glb.document["meshes"][3]["name"] == "floor");
    CHECK_FALSE(glb.document["meshes"][3].contains("weights"));
    CHECK(glb.document["materials"].back()["doubleSided"] == true);
    const Json& animation = glb.document["animations"][0];
    REQUIRE(animation["channels"].size() == 4);
    CHECK(animation["channels"][3]["target"] == Json({{"node", 3}, {"path", "translation"}}));
    const std::size_t sampler = animation["channels"][3]["sampler"].get<std::size_t>();
    const auto places = glb.floats(animation["samplers"][sampler]["output"].get<std::size_t>());
    REQUIRE(places.size() == 15);
    CHECK(std::vector<float>(places.end() - 3, places.end()) == std::vector<float>{0.004F, 0.012F, -0.008F});
}

TEST_CASE("a robot with a rest state only has no animation") {
    auto robot = report::test::bent_bar(1, 1);
    robot.result.steps.pop_back();
    const Glb glb = glb_of(robot, 40);
    CHECK_FALSE(glb.document.contains("animations"));
    CHECK_FALSE(glb.document["meshes"][0]["primitives"][0].contains("targets"));
}

TEST_CASE("steps are thinned evenly, and the last one is kept") {
    CHECK(thinned_steps(11, 40) == std::vector<std::size_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
    CHECK(thinned_steps(101, 4) == std::vector<std::size_t>{25, 50, 75, 100});
    CHECK(thinned_steps(8, 3) == std::vector<std::size_t>{2, 5, 7});
    CHECK(thinned_steps(1, 3).empty());
}
