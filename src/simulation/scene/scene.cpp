#include "simulation/scene/scene.hpp"

#include <utility>

#include "base/core/stopwatch.hpp"
#include "robot/bodies/build.hpp"
#include "simulation/scene/build_model.hpp"

namespace pliant::robot {

Result<Scene> build_scene(Robot robot, Progress& progress) {
    Stopwatch watch;
    Result<mesh::TetMesh> mesh = build_mesh(robot, progress);
    if (!mesh) return tl::unexpected(mesh.error());
    const double mesh_s = watch.read_s();
    std::vector<std::string> notes = mesh->notes;
    Result<sim::Model> model = build_model(robot, std::move(*mesh));
    if (!model) return tl::unexpected(model.error());
    return Scene{std::move(robot), std::move(*model), std::move(notes), mesh_s, watch.read_s()};
}

}  // namespace pliant::robot
