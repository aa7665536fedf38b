#include "studio/simulate/preview.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/scene/scene.hpp"
#include "studio/base/test_events.hpp"

using namespace pliant;
using namespace pliant::studio;

namespace {

robot::Scene scene_of(const std::vector<std::string>& assignments) {
    Progress silent;
    auto robot = robot::parse_robot(studio::test::bar, "bar.toml", assignments);
    REQUIRE(robot);
    auto scene = robot::build_scene(std::move(*robot), silent);
    REQUIRE(scene);
    return std::move(*scene);
}

}  // namespace

TEST_CASE("a preview has the linear tets of the mesh, and a linear motion is transferred exactly") {
    const robot::Scene fine = scene_of({});
    const auto preview = Preview::of(fine.robot, fine.model);
    REQUIRE(preview != nullptr);
    const mesh::TetMesh& coarse = preview->model().mesh();
    CHECK(coarse.order == 1);
    CHECK(coarse.tet_count() == fine.model.mesh().tet_count());
    CHECK(mesh::volume(coarse) == near(mesh::volume(fine.model.mesh()), {.relative = 1e-12}));
    const auto moved = [](const Vec3& p) { return Vec3{2 * p.x + 0.3 * p.y, p.y - 0.1 * p.z, p.z + 1e-3}; };
    std::vector<Vec3> corners;
    for (const Vec3& p : coarse.points) corners.push_back(moved(p));
    const sim::NodePositions lifted = preview->lifted(sim::NodePositions(std::move(corners)));
    double worst = 0;
    for (std::size_t v = 0; v < lifted.size(); ++v)
        worst = std::max(worst, norm(lifted[v] - moved(fine.model.mesh().points[v])));
    CHECK(worst < 1e-15);
}

TEST_CASE("linear tets have no preview") {
    const robot::Scene linear = scene_of({"mesh.order=1"});
    CHECK(Preview::of(linear.robot, linear.model) == nullptr);
}
