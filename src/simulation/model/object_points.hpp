// Surface points of rigid objects: contact treats them as nodes; the four nodes of each object carry them.
//
// Contact positions are (3n) those of the mesh's nodes, then of these points, then of obstacle nodes.
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
    /// `first`: the number of the mesh's nodes. `bodies`: one for each object.
    ObjectPoints(std::span<const FreeObject> objects, std::span<const AffineBody> bodies, int first);

    [[nodiscard]] int count() const { return static_cast<int>(body_.size()); }
    /// The rigid parts for contact, one for each object.
    [[nodiscard]] const std::vector<contact::RigidPart>& parts() const { return parts_; }
    /// `surface` with the triangles of all objects.
    [[nodiscard]] contact::Surface with_objects(contact::Surface surface, std::span<const FreeObject> objects) const;

    /// Appends the positions of the points, or their motion, to those of the nodes (3n).
    void append(std::span<const double> nodes, std::vector<double>& all) const;
    /// forces (3n) += forces on the points (3 count), transferred to the nodes.
    void add_forces(std::span<const double> on_points, std::span<double> forces) const;
    /// The mesh nodes that carry contact's node `i`: the node itself if it is one of them, none for an obstacle's.
    [[nodiscard]] std::span<const int> carriers(const int& i) const;
    /// Calls `visit` with the blocks between mesh nodes that result from a block between contact's nodes i and j.
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
