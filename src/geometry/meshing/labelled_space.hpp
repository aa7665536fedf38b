// Which of several surfaces has a point.
#pragma once

#include <vector>

#include "geometry/meshing/winding_grid.hpp"

namespace pliant::mesh {

/// Space by the surfaces that wind around it more than half a time; where several do, the last of them has it.
class LabelledSpace {
public:
    explicit LabelledSpace(std::vector<TriMesh> surfaces);

    /// 0: none; i + 1: surface i.
    [[nodiscard]] int label(const Vec3& point) const;

    [[nodiscard]] const std::vector<WindingGrid>& surfaces() const { return surfaces_; }

private:
    std::vector<WindingGrid> surfaces_;
};

}  // namespace pliant::mesh
