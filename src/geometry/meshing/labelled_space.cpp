#include "geometry/meshing/labelled_space.hpp"

#include <utility>

namespace pliant::mesh {

LabelledSpace::LabelledSpace(std::vector<TriMesh> surfaces) {
    surfaces_.reserve(surfaces.size());
    for (TriMesh& surface : surfaces) surfaces_.emplace_back(std::move(surface));
}

int LabelledSpace::label(const Vec3& point) const {
    constexpr double inside = 0.5;
    for (std::size_t i = surfaces_.size(); i-- > 0;) {
        // The winding number outside a surface's box is at most one half.
        const WindingGrid& surface = surfaces_[i];
        if (surface.box().contains(point) && surface.winding_number(point) > inside) return static_cast<int>(i) + 1;
    }
    return 0;
}

}  // namespace pliant::mesh
