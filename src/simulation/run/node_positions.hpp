// Positions of all nodes of a mesh: immutable, shared by all copies.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::sim {

/// (nodes) metres. Copies are cheap.
class NodePositions {
public:
    NodePositions() = default;
    NodePositions(std::vector<Vec3> points) {  // NOLINT(google-explicit-constructor): it is one
        auto owned = std::make_shared<const std::vector<Vec3>>(std::move(points));
        points_ = *owned;
        owner_ = std::move(owned);
    }
    /// `points` must be valid as long as `owner` exists.
    NodePositions(std::shared_ptr<const void> owner, std::span<const Vec3> points)
        : owner_(std::move(owner)), points_(points) {}

    operator std::span<const Vec3>() const { return points_; }  // NOLINT(google-explicit-constructor): it is one
    [[nodiscard]] std::size_t size() const { return points_.size(); }
    [[nodiscard]] bool empty() const { return points_.empty(); }
    [[nodiscard]] const Vec3& operator[](std::size_t node) const { return points_[node]; }
    [[nodiscard]] const Vec3* data() const { return points_.data(); }
    [[nodiscard]] auto begin() const { return points_.begin(); }
    [[nodiscard]] auto end() const { return points_.end(); }

    friend bool operator==(const NodePositions& a, const NodePositions& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end());
    }

private:
    std::shared_ptr<const void> owner_;
    std::span<const Vec3> points_;
};

}  // namespace pliant::sim
