#include "presentation/report/frames.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/vtu_writer.hpp"
#include "presentation/report/test_robot.hpp"

using namespace pliant;
using namespace pliant::report;

namespace {

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
    const std::size_t from = text.find(begin);
    REQUIRE(from != std::string::npos);
    return text.substr(from, text.find(end, from) - from);
}

}  // namespace

TEST_CASE("every step is a frame in millimetres, and the collection gives its time") {
    const auto robot = report::test::bent_bar(3, 2);
    const pliant::test::Folder folder("frames");
    Progress progress;
    REQUIRE(write_frames(folder.path(), robot.simulation(), progress).has_value());
    const auto collection = read_file(folder.path() / "frames.pvd");
    REQUIRE(collection.has_value());
    CHECK(collection->find("timestep=\"0\" part=\"0\" file=\"frames/frame_0000.vtu\"") != std::string::npos);
    CHECK(collection->find("timestep=\"1\" part=\"0\" file=\"frames/frame_0003.vtu\"") != std::string::npos);
    CHECK(collection->find("frame_0004") == std::string::npos);

    const auto frame = read_file(folder.path() / "frames/frame_0003.vtu");
    REQUIRE(frame.has_value());
    std::vector<Vec3> points_mm;
    for (const Vec3& p : robot.result.steps.back().positions) points_mm.push_back(1e3 * p);
    const auto bare = mesh::vtu_text(robot.mesh, points_mm, {});
    REQUIRE(bare.has_value());
    CHECK(between(*frame, "<Points>", "</Cells>") == between(*bare, "<Points>", "</Cells>"));
    for (const char* name : {"region", "material", "J", "von_mises_kPa", "max_stretch", "energy_density_kPa"}) {
        CHECK(between(*frame, "<CellData>", "</CellData>").find("Name=\"" + std::string(name) + "\"") !=
              std::string::npos);
    }
    CHECK(between(*frame, "<PointData>", "</PointData>").find("displacement_mm\" NumberOfComponents=\"3\"") !=
          std::string::npos);
}

TEST_CASE("frames name their regions, and have no points that belong to no tet") {
    auto robot = report::test::bent_bar(1, 2);
    const mesh::TetMesh bodies = robot.mesh;
    robot.mesh.points.push_back({1, 2, 3});  // as of an object
    for (sim::Step& step : robot.result.steps) {
        std::vector<Vec3> positions(step.positions.begin(), step.positions.end());
        positions.push_back({4, 5, 6});
        step.positions = positions;
    }
    Simulation s = robot.simulation();
    s.contact_pressure_Pa = [&](const sim::Step&) { return std::vector<double>(robot.mesh.points.size()); };
    const pliant::test::Folder folder("frames_bodies");
    Progress progress;
    REQUIRE(write_frames(folder.path(), s, progress).has_value());
    const auto back = mesh::read_tet_mesh(folder.path() / "frames/frame_0001.vtu");
    REQUIRE_MESSAGE(back, (back ? "" : back.error().message));
    CHECK(back->points.size() == bodies.points.size());
    CHECK(back->region_names == bodies.region_names);
    const auto frame = read_file(folder.path() / "frames/frame_0001.vtu");
    CHECK(frame->find(fmt::format("NumberOfPoints=\"{}\"", bodies.points.size())) != std::string::npos);
}

TEST_CASE("contact pressure is written as point data when there is contact") {
    const auto robot = report::test::bent_bar(1, 1);
    Simulation s = robot.simulation();
    s.contact_pressure_Pa = [&](const sim::Step& step) {
        return std::vector<double>(robot.mesh.points.size(), 1e3 * step.index);
    };
    const pliant::test::Folder folder("frames_contact");
    Progress progress;
    REQUIRE(write_frames(folder.path(), s, progress).has_value());
    const auto frame = read_file(folder.path() / "frames/frame_0001.vtu");
    REQUIRE(frame.has_value());
    CHECK(between(*frame, "<PointData>", "</PointData>").find("Name=\"contact_pressure_kPa\"") != std::string::npos);
}

TEST_CASE("writing frames can be cancelled") {
    struct Stop : Progress {
        [[nodiscard]] bool cancelled() const override { return true; }
    } stop;
    const pliant::test::Folder folder("frames_cancelled");
    const auto status = write_frames(folder.path(), report::test::bent_bar(3, 1).simulation(), stop);
    REQUIRE_FALSE(status.has_value());
    CHECK(status.error().cause == Cause::cancelled);
}
