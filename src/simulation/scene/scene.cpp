#include "simulation/scene/scene.hpp"

#include <utility>

#include "base/core/stopwatch.hpp"
#include "robot/bodies/build.hpp"
#include "simulation/scene/build_model.hpp"

namespace pliant::robot {
namespace {

Result<Scene> scene_of(Robot robot, Result<mesh::TetMesh> mesh, Stopwatch watch) {
    if (!mesh) return tl::unexpected(mesh.error());
    const double mesh_s = watch.read_s();
    std::vector<std::string> notes = mesh->notes;
    Result<sim::Model> model = build_model(robot, std::move(*mesh));
    if (!model) return tl::unexpected(model.error());
    return Scene{std::move(robot), std::move(*model), std::move(notes), mesh_s, watch.read_s()};
}

}  // namespace

Result<Scene> build_scene(Robot robot, Progress& progress) {
    const Stopwatch watch;
    Result<mesh::TetMesh> mesh = build_mesh(robot, progress);
    return scene_of(std::move(robot), std::move(mesh), watch);
}

Result<Scene> build_scene(Robot robot, mesh::TetMesh mesh_m) {
    const Stopwatch watch;
    Result<mesh::TetMesh> mesh = take_mesh(robot, std::move(mesh_m));
    return scene_of(std::move(robot), std::move(mesh), watch);
}

}  // namespace pliant::robot
