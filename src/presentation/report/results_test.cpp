#include "presentation/report/results.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/stopwatch.hpp"
#include "base/core/test_folder.hpp"
#include "presentation/report/test_robot.hpp"

using namespace pliant;
using namespace pliant::report;

namespace {

constexpr PictureChoice all_small = {PictureSet::all, {240, 150}};

/// Names in pictures/, sorted; none if there is no such folder.
std::vector<std::string> pictures_in(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    if (!std::filesystem::exists(folder / "pictures")) return names;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "pictures"))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

/// Cancelled from the start, or once the stage of this name is reported.
struct Stop : Progress {
    std::string stage;
    bool stopped = true;
    explicit Stop(std::string from_stage = "") : stage(std::move(from_stage)), stopped(stage.empty()) {}
    void advance(std::string_view name, double) override { stopped = stopped || name == stage; }
    [[nodiscard]] bool cancelled() const override { return stopped; }
};

}  // namespace

TEST_CASE("the folder holds every file that the design names") {
    const auto robot = report::test::bent_bar(3, 1);
    const pliant::test::Folder folder("results");
    Progress progress;
    const auto written = write_results(folder.path(), robot.simulation(), all_small, progress, progress);
    REQUIRE_MESSAGE(written.has_value(), written.error().message);
    CHECK_FALSE(written->drawing_stopped);
    for (const char* name : {"summary.json", "steps.csv", "markers.csv", "iterations.csv", "frames.pvd",
                             "frames/frame_0000.vtu", "frames/frame_0003.vtu", "robot.glb", "pictures/rest.png",
                             "pictures/final.png", "pictures/stages.png", "pictures/von_mises.png", "report.html"}) {
        CHECK_MESSAGE(std::filesystem::file_size(folder.path() / name) > 100, name);
    }
}

TEST_CASE("no, few or all pictures are drawn, and the page shows those that exist") {
    const auto robot = report::test::bent_bar(2, 1);
    Progress progress;
    const std::vector<std::pair<PictureSet, std::vector<std::string>>> sets = {
        {PictureSet::none, {}},
        {PictureSet::few, {"final.png"}},
        {PictureSet::all, {"final.png", "rest.png", "stages.png", "von_mises.png"}}};
    for (const auto& [set, names] : sets) {
        const pliant::test::Folder folder("pictures");
        const auto written = write_results(folder.path(), robot.simulation(), {set, {240, 150}}, progress, progress);
        REQUIRE(written.has_value());
        CHECK(pictures_in(folder.path()) == names);
        CHECK((written->timing.pictures_s > 0) == !names.empty());
        const std::string html = read_file(folder / "report.html").value();
        std::size_t shown = 0;
        for (std::size_t at = 0; (at = html.find("<img ", at)) != std::string::npos; ++at) ++shown;
        CHECK(shown == names.size());
        CHECK((html.find("class=\"pictures\"") == std::string::npos) == names.empty());
        CHECK(html.find("<h2>Steps</h2>") != std::string::npos);
    }
    CHECK(PictureChoice{}.set == PictureSet::few);
    CHECK(PictureChoice{}.size.width_px == 800);
}

TEST_CASE("a film is written on request, and is left out if its drawing is cancelled") {
    const auto robot = report::test::bent_bar(3, 1);
    Progress progress;
    const PictureChoice choice{.set = PictureSet::few, .size = {240, 150}, .film = true};
    const pliant::test::Folder folder("film");
    REQUIRE(write_results(folder.path(), robot.simulation(), choice, progress, progress));
    const std::string gif = read_file(folder / "film.gif").value();
    CHECK(gif.starts_with("GIF89a"));
    const auto size = [&](std::size_t at) { return static_cast<unsigned char>(gif[at]) + 256 * gif[at + 1]; };
    CHECK(size(6) == usual_film_size.width_px);
    CHECK(size(8) == usual_film_size.height_px);
    const pliant::test::Folder other("no_film");
    Stop drawing("film");
    const auto written = write_results(other.path(), robot.simulation(), choice, progress, drawing);
    REQUIRE(written);
    CHECK(written->drawing_stopped);
    CHECK_FALSE(std::filesystem::exists(other / "film.gif"));
    CHECK(pictures_in(other.path()) == std::vector<std::string>{"final.png"});
}

TEST_CASE("summary.json holds the time for files and pictures, as part of the whole") {
    const auto robot = report::test::bent_bar(2, 1);
    Simulation s = robot.simulation();
    s.timing = {1.5, 0.5, 0, 0};
    Progress progress;
    const pliant::test::Folder folder("timing");
    Stopwatch watch;
    const auto written = write_results(folder.path(), s, {PictureSet::few, {240, 150}}, progress, progress);
    const double whole_ms = 1e3 * watch.read_s();
    REQUIRE(written.has_value());
    const auto timing = nlohmann::json::parse(read_file(folder / "summary.json").value())["timing"];
    CHECK(timing["mesh_ms"] == 1500);
    CHECK(timing["files_ms"].get<double>() == near(1e3 * written->timing.files_s, {.relative = 1e-12}));
    CHECK(timing["pictures_ms"].get<double>() == near(1e3 * written->timing.pictures_s, {.relative = 1e-12}));
    CHECK(timing["files_ms"].get<double>() > 0);
    CHECK(timing["pictures_ms"].get<double>() > 0);
    CHECK(timing["files_ms"].get<double>() + timing["pictures_ms"].get<double>() < whole_ms);
}

TEST_CASE("cancelled while drawing, only the pictures are missing; cancelled while writing, it is an error") {
    const auto robot = report::test::bent_bar(2, 1);
    Progress progress;
    for (const char* stage : {"", "pictures"}) {
        Stop drawing(stage);
        const pliant::test::Folder folder("drawing_stopped");
        const auto written = write_results(folder.path(), robot.simulation(), all_small, progress, drawing);
        REQUIRE(written.has_value());
        CHECK(written->drawing_stopped);
        CHECK_FALSE(std::filesystem::exists(folder / "pictures"));
        for (const char* name : {"summary.json", "steps.csv", "frames/frame_0002.vtu", "robot.glb", "report.html"})
            CHECK_MESSAGE(std::filesystem::file_size(folder / name) > 100, name);
    }
    for (const char* stage : {"", "frames", "pictures"}) {
        Stop writing(stage);
        const pliant::test::Folder folder("writing_stopped");
        const auto written = write_results(folder.path(), robot.simulation(), all_small, writing, writing);
        REQUIRE_FALSE(written.has_value());
        CHECK(written.error().cause == Cause::cancelled);
    }
}

TEST_CASE("a rest state alone, and a robot without cables or markers, are reported") {
    auto robot = report::test::bent_bar(1, 1);
    robot.result.steps.pop_back();
    robot.result.steps[0].cables.clear();
    robot.result.steps[0].markers.clear();
    robot.result.steps[0].supports.clear();
    robot.cable_points.clear();
    robot.result.converged = false;
    robot.result.message = "step 1: did not converge";
    const pliant::test::Folder folder("rest_only");
    Progress progress;
    CHECK(write_results(folder.path(), robot.simulation(), all_small, progress, progress).has_value());
    const auto html = read_file(folder.path() / "report.html");
    REQUIRE(html.has_value());
    CHECK(html->find("step 1: did not converge") != std::string::npos);
}

TEST_CASE("inconsistent input is refused with the reason") {
    const auto refused = [](const report::test::Robot& robot, auto change) {
        Simulation s = robot.simulation();
        change(s);
        const auto status = check(s);
        return status ? std::string("accepted") : status.error().message;
    };
    const auto robot = report::test::bent_bar(2, 1);
    CHECK(refused(robot, [](Simulation&) {}) == "accepted");
    CHECK(refused(robot, [](Simulation& s) { s.region_material = {0}; }) ==
          "report: region_material has 1 entries, the mesh 2 regions");
    CHECK(refused(robot, [](Simulation& s) {
              s.region_material = {0, 2};
          }) == "report: region_material names material 2 of 2");
    CHECK(refused(robot, [](Simulation& s) { s.cable_points.pop_back(); }) == "report: cable_points has 2 steps of 3");
    CHECK(refused(robot, [](Simulation& s) { s.materials.clear(); }) == "report: at least one material is needed");
    CHECK(refused(robot, [](Simulation& s) { s.fields = nullptr; }) == "report: no function for the fields");

    auto broken = report::test::bent_bar(2, 1);
    const std::span<const Vec3> all = broken.result.steps[1].positions;
    broken.result.steps[1].positions = std::vector<Vec3>(all.begin(), all.end() - 1);
    CHECK(refused(broken, [](Simulation&) {}).starts_with("report: step 1 has "));
    broken = report::test::bent_bar(2, 1);
    const std::span<const Vec3> here = broken.result.steps[2].positions;
    std::vector<Vec3> positions(here.begin(), here.end());
    positions[7].y = std::nan("");
    broken.result.steps[2].positions = positions;
    CHECK(refused(broken, [](Simulation&) {}) == "report: step 2 has positions that are not numbers");
    broken = report::test::bent_bar(2, 1);
    broken.result.steps[2].markers.clear();
    CHECK(refused(broken, [](Simulation&) {}).starts_with("report: step 2 has other cables"));
    broken = report::test::bent_bar(2, 1);
    broken.mesh.nodes[5] = 1 << 30;
    CHECK(refused(broken, [](Simulation&) {}).starts_with("report: a tet names node "));
}

TEST_CASE("a folder that cannot be written is an error") {
    const auto robot = report::test::bent_bar(1, 1);
    Progress progress;
    CHECK_FALSE(write_results("/proc/no_such_folder", robot.simulation(), all_small, progress, progress).has_value());
}
