#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "geometry/files/tet_collector.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "library/base/calls.hpp"
#include "library/simulation/data.hpp"
#include "simulation/run/warnings.hpp"

namespace pliant {
namespace {

template <class T>
std::vector<std::string> names_of(const std::vector<T>& all) {
    std::vector<std::string> names;
    for (const T& one : all) names.push_back(one.name);
    return names;
}

[[noreturn]] void refuse(const std::string& why) {
    throw Failure(Failure::Kind::input, "the mesh: " + why);
}

/// Before anything else is said of the body that has one: it hangs on nothing, or cannot be simulated.
void refuse_flat_tets(const mesh::TetMesh& mesh) {
    const auto width = static_cast<std::size_t>(mesh.nodes_per_tet());
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const int* n = mesh.nodes.data() + t * width;
        const auto at = [&](int corner) { return mesh.points[static_cast<std::size_t>(n[corner])]; };
        const double volume = mesh::signed_tet_volume(at(0), at(1), at(2), at(3));
        if (!(volume > 0))
            throw Failure(
                Failure::Kind::input,
                fmt::format("tetrahedron {} of the mesh is flat or inside out at rest (volume {:.3g} m^3)", t, volume));
    }
}

void check_step_options(const StepOptions& options) {
    constexpr double least = 1e-10, most = 0.1;
    if (options.tolerance && !(*options.tolerance >= least && *options.tolerance <= most))
        throw Failure(Failure::Kind::input,
                      fmt::format("a tolerance of {:g} is not possible: it is between {:g} and {:g}",
                                  *options.tolerance, least, most));
    if (options.iteration_limit && *options.iteration_limit < 0)
        throw Failure(Failure::Kind::input, "the iteration limit is negative");
}

/// The robot with the options as changes of its file: whatever reads its program follows them.
std::shared_ptr<const Robot::Data> with_options(const std::shared_ptr<const Robot::Data>& robot,
                                                const StepOptions& options) {
    check_step_options(options);
    std::vector<std::string> changes;
    if (options.tolerance) changes.push_back(fmt::format("program.tolerance={}", *options.tolerance));
    if (options.iteration_limit) changes.push_back(fmt::format("program.max_iterations={}", *options.iteration_limit));
    if (changes.empty()) return robot;
    Robot::Data data = *robot;
    data.robot = library::value_of(library::read_again(*robot, changes));
    data.changes.insert(data.changes.end(), changes.begin(), changes.end());
    return std::make_shared<const Robot::Data>(std::move(data));
}

}  // namespace

mesh::TetMesh library::tet_mesh(const Mesh& given) {
    if (given.nodes_per_tet != 4 && given.nodes_per_tet != 10)
        refuse(fmt::format("{} nodes for each tetrahedron; it has 4 or 10", given.nodes_per_tet));
    const auto width = static_cast<std::size_t>(given.nodes_per_tet);
    const std::size_t tets = given.tets.size() / width;
    if (tets * width != given.tets.size())
        refuse(fmt::format("{} node numbers are no multiple of {}", given.tets.size(), width));
    if (!given.regions.empty() && given.regions.size() != tets)
        refuse(fmt::format("{} tetrahedra, but {} regions of them", tets, given.regions.size()));
    std::vector<Vec3> points;
    for (const Point& p : given.points) {
        points.push_back({p[0], p[1], p[2]});
        if (!is_finite(points.back())) refuse(fmt::format("point {} is not finite", points.size() - 1));
    }
    mesh::TetCollector collector(std::move(points));
    for (std::size_t t = 0; t < tets; ++t) {
        const int region = given.regions.empty() ? 0 : given.regions[t];
        if (region < 0 || static_cast<std::size_t>(region) >= given.region_names.size())
            refuse(fmt::format("a tetrahedron is in region {} of {}", region, given.region_names.size()));
        const std::vector<std::int64_t> nodes(given.tets.begin() + static_cast<std::ptrdiff_t>(t * width),
                                              given.tets.begin() + static_cast<std::ptrdiff_t>((t + 1) * width));
        if (const Status status = collector.add(nodes, region); !status) refuse(status.error().message);
    }
    for (auto name = given.region_names.begin(); name != given.region_names.end(); ++name)
        if (std::find(given.region_names.begin(), name, *name) != name)
            refuse(fmt::format("two regions are named \"{}\"; each needs a name of its own", *name));
    std::map<std::int64_t, std::string> names;
    for (const std::string& name : given.region_names) names.emplace(names.size(), name);
    auto mesh = collector.finish(names);
    if (!mesh) refuse(mesh.error().message);
    refuse_flat_tets(*mesh);
    return std::move(*mesh);
}

Model::Model(const Robot& robot, const Mesh& mesh, const StepOptions& options) {
    mesh::TetMesh given = library::tet_mesh(mesh);
    std::shared_ptr<const Robot::Data> solved = with_options(robot.shared(), options);
    robot::Scene scene = library::value_of(robot::build_scene(solved->robot, given));
    data_ = std::make_shared<const Data>(Data{std::move(scene), std::move(solved), std::move(given)});
}

Model::Model(const Robot& robot, const StepOptions& options, const Watch& watch) {
    std::shared_ptr<const Robot::Data> solved = with_options(robot.shared(), options);
    library::WatchedProgress progress(watch, "mesh");
    auto scene = robot::build_scene(solved->robot, progress);
    progress.rethrow();
    data_ = std::make_shared<const Data>(Data{library::value_of(std::move(scene)), std::move(solved)});
}

Model::Model(const Robot& robot, const Mesh& mesh) : Model(robot, mesh, StepOptions{}) {}
Model::Model(const Robot& robot, const Watch& watch) : Model(robot, StepOptions{}, watch) {}

std::size_t Model::node_count() const {
    return data_->scene.model.mesh().points.size();
}
std::size_t Model::tet_count() const {
    return data_->scene.model.mesh().tet_count();
}
int Model::order() const {
    return data_->scene.model.mesh().order;
}
std::vector<Point> Model::rest_positions() const {
    return library::points_of(data_->scene.model.mesh().points);
}
std::span<const double> Model::rest_coordinates() const {
    return library::numbers_of(data_->scene.model.mesh().points);
}
const std::vector<int>& Model::tets() const {
    return data_->scene.model.mesh().nodes;
}
const std::vector<int>& Model::regions() const {
    return data_->scene.model.mesh().region;
}
const std::vector<std::string>& Model::region_names() const {
    return data_->scene.model.mesh().region_names;
}
std::vector<std::array<int, 3>> Model::surface() const {
    std::vector<std::array<int, 3>> triangles;
    for (const mesh::Face& face : mesh::boundary_faces(data_->scene.model.mesh()))
        triangles.push_back({face.nodes[0], face.nodes[1], face.nodes[2]});
    return triangles;
}
std::vector<std::string> Model::cables() const {
    return names_of(data_->scene.model.description().cables);
}
std::vector<std::string> Model::chambers() const {
    return names_of(data_->scene.model.description().chambers);
}
std::vector<std::string> Model::markers() const {
    return names_of(data_->scene.model.description().markers);
}
std::vector<std::string> Model::warnings() const {
    return sim::warnings_at_rest(data_->scene.model);
}

}  // namespace pliant
