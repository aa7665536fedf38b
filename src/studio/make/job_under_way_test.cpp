#include "studio/make/job_under_way.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

using namespace pliant;
using namespace pliant::studio;
using Json = nlohmann::json;

namespace {

job::Manifest manifest_of(int layers) {
    job::Manifest m;
    m.name = "tower";
    m.width_px = m.height_px = 16;
    m.pixel_um = 50;
    m.materials = {{"soft", "flex", 0, 0, 2, 8}, {"firm", "hard", 0, 0, 3, 9}};
    for (int k = 0; k < layers; ++k)
        m.layers.push_back({50 * (k + 1), 50, {{1, job::image_file_name(k, "firm"), 1.0 + k}}});
    return m;
}

void add(JobUnderWay& job, int layers, int count) {
    job.add(manifest_of(layers), count, {{16, 16, "png of layer " + std::to_string(layers - 1)}},
            {"#111111", "#222222"});
}

}  // namespace

TEST_CASE("the first layers can be viewed before slicing ends") {
    JobUnderWay job;
    CHECK(job.json() == "null");
    CHECK(job.layers() == 0);
    for (int n = 1; n <= 3; ++n) add(job, n, 900);
    const Json told = Json::parse(job.json());
    CHECK(told["layers"] == 3);
    CHECK(told["count"] == 900);
    CHECK(told["colours"] == Json{"#111111", "#222222"});
    CHECK(told["manifest"]["layers"].size() == 3);
    CHECK(told["manifest"]["layers"][2]["number"] == 2);
    CHECK(job.image(1, 1).value() == "png of layer 1");
    CHECK_FALSE(job.image(1, 0).has_value());
    CHECK_FALSE(job.image(3, 1).has_value());
    job.clear();
    CHECK(job.json() == "null");
    CHECK_FALSE(job.image(1, 1).has_value());
}

TEST_CASE("of a large job, evenly spaced layers are kept for viewing") {
    JobUnderWay job;
    constexpr int count = 1000;
    for (int n = 1; n <= count; ++n) add(job, n, count);
    const Json told = Json::parse(job.json());
    CHECK(told["layers"] == count);
    const std::size_t kept = told["manifest"]["layers"].size();
    CHECK(kept <= JobUnderWay::most_kept);
    CHECK(kept >= JobUnderWay::most_kept / 2);
    CHECK(told["manifest"]["layers"][0]["number"] == 0);
    CHECK(told["manifest"]["layers"][kept - 1]["number"] > count - 2 * count / static_cast<int>(kept) - 1);
}
