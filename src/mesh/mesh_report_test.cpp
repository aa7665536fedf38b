#include "mesh/mesh_report.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace pliant;
using namespace pliant::mesh;

namespace {

TetMesh one_tet(const std::vector<Vec3>& points) {
    TetMesh mesh;
    mesh.points = points;
    mesh.nodes = {0, 1, 2, 3};
    mesh.region = {0};
    mesh.region_names = {"a"};
    return mesh;
}

}  // namespace

TEST_CASE("a regular tet has quality 1 and dihedral angles of acos(1/3)") {
    const MeshReport report = report_on(one_tet({{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}}));
    CHECK(report.worst_quality == doctest::Approx(1));
    CHECK(report.min_dihedral_deg == doctest::Approx(std::acos(1.0 / 3) * 180 / std::numbers::pi));
    CHECK(report.region_volumes.front() == doctest::Approx(8.0 / 3));
}

TEST_CASE("a corner of a cube has angles of 90 and acos(1/sqrt 3), and longest edge sqrt 2") {
    const MeshReport report = report_on(one_tet({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
    CHECK(report.worst_quality == doctest::Approx(0.5));  // 6 sqrt 2 (1/6) / (2 sqrt 2)
    CHECK(report.min_dihedral_deg == doctest::Approx(54.7356).epsilon(1e-5));
}

TEST_CASE("the text names size, regions and quality; an empty mesh has a report too") {
    const std::string text = report_text(report_on(one_tet({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})));
    CHECK(text.find("4 nodes, 1 linear tets, 1 x 1 x 1") == 0);
    CHECK(text.find("region \"a\": volume 0.166667") != std::string::npos);
    CHECK(report_on({}).tets == 0);
}
