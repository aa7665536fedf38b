// The points of the surfaces of rigid objects: what contact knows as nodes, and the four nodes of each object carry.
//
// Contact sees (3n) positions of the mesh's nodes, then those of these points, then those of obstacles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "base/linalg/small.hpp"
#include "simulation/contact/friction.hpp"
#include "simulation/elements/affine_body.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

class ObjectPoints {
public:
    ObjectPoints() = default;
    /// `first`: the number of the mesh's nodes. `bodies` as the objects.
    ObjectPoints(std::span<const FreeObject> objects, std::span<const AffineBody> bodies, int first);

    [[nodiscard]] int count() const { return static_cast<int>(body_.size()); }
    /// Of each object, for contact.
    [[nodiscard]] const std::vector<contact::RigidPart>& parts() const { return parts_; }
    /// `surface` with the triangles of all objects.
    [[nodiscard]] contact::Surface with_objects(contact::Surface surface, std::span<const FreeObject> objects) const;

    /// Appends the positions of the points, or their motion, to those of the nodes (3n).
    void append(std::span<const double> nodes, std::vector<double>& all) const;
    /// forces (3n) += what forces on the points (3 count) are on the nodes.
    void add_forces(std::span<const double> on_points, std::span<double> forces) const;
    /// The nodes of the mesh that carry contact's node `i`: itself, where it is one of them, none for an obstacle's.
    [[nodiscard]] std::span<const int> carriers(const int& i) const;
    /// Calls `visit` with the blocks between nodes of the mesh that a block between contact's nodes i and j makes.
    void visit_block(int i, int j, const linalg::Matrix3& block, const contact::BlockVisitor& visit) const;

private:
    [[nodiscard]] double share(int i, std::size_t a) const {
        return i < first_ ? 1 : shares_[static_cast<std::size_t>(i - first_)][a];
    }

    int first_ = 0;
    std::vector<contact::RigidPart> parts_;
    std::vector<std::array<int, 4>> nodes_;  ///< (objects)
    std::vector<int> body_;                  ///< (points) object
    std::vector<std::array<double, 4>> shares_;
};

}  // namespace pliant::sim
