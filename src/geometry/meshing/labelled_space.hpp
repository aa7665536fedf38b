// Decides which of several surfaces a point belongs to.
#pragma once

#include <vector>

#include "geometry/meshing/winding_grid.hpp"

namespace pliant::mesh {

/// A point belongs to a surface whose winding number there is above one half; if several qualify, to the last of them.
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
