#include "mesh/labelled_space.hpp"

#include <utility>

namespace pliant::mesh {

LabelledSpace::LabelledSpace(std::vector<TriMesh> surfaces) {
    for (TriMesh& surface : surfaces) {
        boxes_.push_back(bounds(surface));
        trees_.emplace_back(std::move(surface));
    }
}

int LabelledSpace::label(const Vec3& point) const {
    constexpr double inside = 0.5;
    for (std::size_t i = trees_.size(); i-- > 0;) {
        // From outside of its box no surface is seen to fill more than half of what is around.
        if (boxes_[i].contains(point, 0) && trees_[i].winding_number(point) > inside) return static_cast<int>(i) + 1;
    }
    return 0;
}

}  // namespace pliant::mesh
