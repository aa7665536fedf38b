#include "printing/prepare/printed_together.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <functional>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "printing/job/verify.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::job;
using slice::test::box;

namespace {

constexpr double normal_s = 3, bottom_s = 9;

JobSettings settings() {
    JobSettings s{"halves", "0.1.0", 2, {{64, 48, 100}, 50, {}}, {}};
    for (const char* name : {"a", "b", "c"})
        s.materials.push_back({name, name == std::string("b") ? "hard" : "flex", 0, 0, normal_s, bottom_s});
    return s;
}

/// Three cubes of 1 mm in a row: a and c of one resin with b between them, and a piece of c on a.
const std::vector<slice::Body> row{{"a", box({-1500, -500, 0}, {-500, 500, 1000}), ""},
                                   {"b", box({-500, -500, 0}, {500, 500, 1000}), ""},
                                   {"c", box({500, -500, 0}, {1500, 500, 1000}), ""},
                                   {"c", box({-1500, -500, 1000}, {-500, 500, 1500}), ""}};

Manifest made_of(std::span<const slice::Body> bodies, const JobSettings& s) {
    const pliant::test::Folder folder("together");
    const std::filesystem::path path = folder / "job.zip";
    auto writer = Writer::create(path);
    REQUIRE(writer.has_value());
    Progress silent;
    const auto made = slice_to_job(bodies, s, *writer, silent);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    REQUIRE(writer->finish(made->manifest).has_value());
    const auto archive = Archive::open(path);
    REQUIRE_MESSAGE(archive.has_value(), (archive ? "" : archive.error().message));
    CHECK(verify_images(*archive, false, "job").has_value());
    return archive->manifest();
}

std::size_t exposures(const Manifest& m) {
    std::size_t count = 0;
    for (const Layer& layer : m.layers) count += layer.images.size();
    return count;
}

}  // namespace

TEST_CASE("bodies of one resin share an exposure, and the manifest keeps each body's volume") {
    const Manifest m = made_of(row, settings());
    CHECK(exposures(m) == 2 * 20 + 10);
    REQUIRE(m.materials.size() == 2);
    CHECK(m.materials[0].name == "a+c");
    CHECK(m.materials[0].resin == "flex");
    CHECK(m.materials[0].model_volume_mm3 == near(2.5, {.relative = 1e-12}));
    CHECK(m.materials[0].model_area_mm2 == near(6 + 6 + 4, {.relative = 1e-12}));
    REQUIRE(m.materials[0].parts.size() == 2);
    CHECK(m.materials[0].parts[0].name == "a");
    CHECK(m.materials[0].parts[0].model_volume_mm3 == near(1, {.relative = 1e-12}));
    CHECK(m.materials[0].parts[1].name == "c");
    CHECK(m.materials[0].parts[1].model_volume_mm3 == near(1.5, {.relative = 1e-12}));
    CHECK(m.materials[1].name == "b");
    CHECK(m.materials[1].parts.empty());
    CHECK(m.layers[0].images.at(0).area_mm2 == near(2, {.relative = 1e-12}));
    CHECK(m.layers[0].images.at(1).area_mm2 == near(1, {.relative = 1e-12}));
    CHECK(m.warnings.empty());
}

TEST_CASE("bodies whose exposures differ are exposed separately") {
    const auto count = [](const std::function<void(JobSettings&)>& change) {
        JobSettings s = settings();
        change(s);
        return made_of(row, s).materials.size();
    };
    CHECK(count([](JobSettings&) {}) == 2);
    CHECK(count([](JobSettings& s) { s.materials[2].exposure_s = 4; }) == 3);
    CHECK(count([](JobSettings& s) { s.materials[2].bottom_exposure_s = 4; }) == 3);
    CHECK(count([](JobSettings& s) { s.materials[2].resin = "other"; }) == 3);
    CHECK(count([](JobSettings& s) { s.materials[0].resin = s.materials[2].resin = ""; }) == 3);
    CHECK(count([](JobSettings& s) { s.exposures["a"] = {2, 0, 0, 50, {{4, 6, 5}}}; }) == 3);
    CHECK(count([](JobSettings& s) { s.exposures["a"] = s.exposures["c"] = {2, 3, 0, 50, {}}; }) == 2);
    CHECK(count([](JobSettings& s) { s.slicing.bonds = {{"a", "b", 1, 0}}; }) == 3);
}

TEST_CASE("bodies exposed together have the transition layers of their materials") {
    JobSettings s = settings();
    s.exposures["a"] = s.exposures["c"] = {2, 3, 0, 50, {}};
    const Manifest m = made_of(row, s);
    CHECK(m.layers[0].images.at(0).exposure_s == 0);
    CHECK(m.layers[2].images.at(0).exposure_s == near(bottom_s - (bottom_s - normal_s) / 4, {.relative = 1e-12}));
    CHECK(m.layers[2].images.at(1).exposure_s == 0);
}

TEST_CASE("a joined material's name is short, and differs from all other names") {
    JobSettings s = settings();
    s.materials = {{"a", "flex", 0, 0, 3, 9}, {"b", "flex", 0, 0, 3, 9}, {"a+b", "hard", 0, 0, 3, 9}};
    CHECK(printed_together(s.materials, s).materials[0].name == "a+b+");
    s.materials.clear();
    for (int i = 0; i < 20; ++i) s.materials.push_back({fmt::format("m{}", i), "flex", 0, 0, 3, 9});
    CHECK(printed_together(s.materials, s).materials.at(0).name == "m0+m1+m2+17 more");
}
