#include "geometry/repair/surface_check.hpp"

#include <algorithm>
#include <vector>

namespace pliant::mesh {

Status check_closed(const TriMesh& surface) {
    if (surface.triangles.empty()) return input_error("the surface holds no triangles");
    std::vector<std::pair<int, int>> edges;
    for (const auto& t : surface.triangles) {
        for (std::size_t i = 0; i < 3; ++i) edges.emplace_back(t[i], t[(i + 1) % 3]);
    }
    std::sort(edges.begin(), edges.end());
    std::size_t open = 0;
    std::size_t repeated = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        if (i > 0 && edges[i] == edges[i - 1]) ++repeated;
        if (!std::binary_search(edges.begin(), edges.end(), std::pair(edges[i].second, edges[i].first))) ++open;
    }
    if (open > 0)
        return input_error(
            "the surface is not closed: {} edges have no neighbour; repair it in the program that drew it", open);
    if (repeated > 0)
        return input_error("{} edges of the surface belong to more than two triangles; a body needs a simple surface",
                           repeated);
    if (!(signed_volume(surface) > 0)) return input_error("the surface is inside out; turn its normals outwards");
    return {};
}

}  // namespace pliant::mesh
