#include "studio/simulate/preview.hpp"

#include <utility>

#include "simulation/scene/build_model.hpp"

namespace pliant::studio {
namespace {

/// (nodes) consecutive numbers of the corners; -1 for mid-edge nodes.
std::vector<int> number_corners(const mesh::TetMesh& fine) {
    std::vector<int> corner(fine.points.size(), -1);
    for (std::size_t t = 0; t < fine.tet_count(); ++t)
        for (std::size_t k = 0; k < 4; ++k) corner[static_cast<std::size_t>(fine.tet(t)[k])] = 0;
    int next = 0;
    for (int& c : corner)
        if (c == 0) c = next++;
    return corner;
}

mesh::TetMesh without_mid_edges(const mesh::TetMesh& fine, const std::vector<int>& corner) {
    mesh::TetMesh linear;
    linear.region = fine.region;
    linear.region_names = fine.region_names;
    for (std::size_t v = 0; v < corner.size(); ++v)
        if (corner[v] >= 0) linear.points.push_back(fine.points[v]);
    for (std::size_t t = 0; t < fine.tet_count(); ++t)
        for (std::size_t k = 0; k < 4; ++k) linear.nodes.push_back(corner[static_cast<std::size_t>(fine.tet(t)[k])]);
    return linear;
}

}  // namespace

std::unique_ptr<const Preview> Preview::of(const robot::Robot& robot, const sim::Model& fine) {
    if (fine.mesh().order != 2) return nullptr;
    robot::Robot linear = robot;
    linear.mesh.order = 1;
    const std::vector<int> corner = number_corners(fine.mesh());
    Result<sim::Model> model = robot::build_model(linear, without_mid_edges(fine.mesh(), corner));
    if (!model) return nullptr;
    return std::unique_ptr<const Preview>(new Preview(std::move(linear), std::move(*model), fine.mesh(), corner));
}

Preview::Preview(robot::Robot robot, sim::Model model, const mesh::TetMesh& fine, const std::vector<int>& corner)
    : robot_(std::move(robot)), model_(std::move(model)), rest_m_(fine.points), ends_(fine.points.size()) {
    for (std::size_t t = 0; t < fine.tet_count(); ++t) {
        const auto tet = fine.tet(t);
        const auto number = [&](int k) { return corner[static_cast<std::size_t>(tet[static_cast<std::size_t>(k)])]; };
        for (int k = 0; k < 4; ++k)
            ends_[static_cast<std::size_t>(tet[static_cast<std::size_t>(k)])] = {number(k), number(k)};
        for (std::size_t e = 0; e < mesh::edge_corners.size(); ++e)
            ends_[static_cast<std::size_t>(tet[4 + e])] = {number(mesh::edge_corners[e][0]),
                                                           number(mesh::edge_corners[e][1])};
    }
}

sim::NodePositions Preview::lifted(const sim::NodePositions& corners) const {
    std::vector<Vec3> positions = rest_m_;
    const auto moved = [&](int corner) {
        const auto c = static_cast<std::size_t>(corner);
        return corners[c] - model_.mesh().points[c];
    };
    for (std::size_t v = 0; v < positions.size(); ++v) positions[v] += 0.5 * (moved(ends_[v][0]) + moved(ends_[v][1]));
    return positions;
}

}  // namespace pliant::studio
