// Which of several surfaces has a point.
#pragma once

#include <vector>

#include "mesh/triangle_tree.hpp"

namespace pliant::mesh {

/// Space by the surfaces that wind around it more than half a time; where several do, the last of them has it.
class LabelledSpace {
public:
    explicit LabelledSpace(std::vector<TriMesh> surfaces);

    /// 0: none; i + 1: surface i.
    [[nodiscard]] int label(const Vec3& point) const;

    [[nodiscard]] const std::vector<TriangleTree>& trees() const { return trees_; }
    [[nodiscard]] const Box3& box(std::size_t surface) const { return boxes_[surface]; }

private:
    std::vector<TriangleTree> trees_;
    std::vector<Box3> boxes_;
};

}  // namespace pliant::mesh
