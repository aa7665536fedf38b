#include <utility>

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

}  // namespace

Model::Model(const Robot& robot, const Watch& watch) {
    library::WatchedProgress progress(watch);
    auto scene = robot::build_scene(robot.data().robot, progress);
    progress.rethrow();
    data_ = std::make_shared<const Data>(Data{library::value_of(std::move(scene)), robot.data().origin});
}

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
