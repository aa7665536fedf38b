#include "simulation/model/object_points.hpp"

#include <utility>

#include "base/linalg/vectors.hpp"

namespace pliant::sim {

ObjectPoints::ObjectPoints(std::span<const FreeObject> objects, std::span<const AffineBody> bodies, int first)
    : first_(first) {
    for (std::size_t k = 0; k < objects.size(); ++k) {
        const int begin = first_ + count();
        nodes_.push_back(bodies[k].nodes());
        for (const Vec3& p : objects[k].surface.points) {
            body_.push_back(static_cast<int>(k));
            shares_.push_back(bodies[k].shares(linalg::vector(p)));
        }
        parts_.push_back({objects[k].name, begin, first_ + count(), objects[k].friction, objects[k].line});
    }
}

contact::Surface ObjectPoints::with_objects(contact::Surface surface, std::span<const FreeObject> objects) const {
    if (objects.empty()) return surface;
    std::vector<std::array<int, 3>> triangles = std::move(surface.triangles);
    for (std::size_t k = 0; k < objects.size(); ++k) {
        const int first = parts_[k].first;
        for (const auto& t : objects[k].surface.triangles)
            triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    return contact::make_surface(triangles);
}

void ObjectPoints::append(std::span<const double> nodes, std::vector<double>& all) const {
    all.reserve(all.size() + 3 * body_.size());
    for (std::size_t p = 0; p < body_.size(); ++p) {
        linalg::Vector3 sum = linalg::Vector3::Zero();
        for (std::size_t a = 0; a < 4; ++a)
            sum += shares_[p][a] * linalg::view(nodes, nodes_[static_cast<std::size_t>(body_[p])][a]);
        all.insert(all.end(), sum.data(), sum.data() + 3);
    }
}

void ObjectPoints::add_forces(std::span<const double> on_points, std::span<double> forces) const {
    for (std::size_t p = 0; p < body_.size(); ++p) {
        for (std::size_t a = 0; a < 4; ++a) {
            const auto node = static_cast<std::size_t>(nodes_[static_cast<std::size_t>(body_[p])][a]);
            for (std::size_t c = 0; c < 3; ++c) forces[3 * node + c] += shares_[p][a] * on_points[3 * p + c];
        }
    }
}

std::span<const int> ObjectPoints::carriers(const int& i) const {
    if (i < first_) return {&i, 1};
    if (i >= first_ + count()) return {};
    return nodes_[static_cast<std::size_t>(body_[static_cast<std::size_t>(i - first_)])];
}

void ObjectPoints::visit_block(int i, int j, const linalg::Matrix3& block, const contact::BlockVisitor& visit) const {
    const std::span<const int> rows = carriers(i), columns = carriers(j);
    for (std::size_t a = 0; a < rows.size(); ++a)
        for (std::size_t b = 0; b < columns.size(); ++b) visit(rows[a], columns[b], share(i, a) * share(j, b) * block);
}

}  // namespace pliant::sim
