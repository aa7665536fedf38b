#include "geometry/files/mid_edge_order.hpp"

#include <algorithm>
#include <utility>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {
namespace {

using Votes = std::array<std::array<int, 6>, 6>;  ///< (place in the file, edge)

void vote(std::span<const Vec3> points, const TenNodes& tet, Votes& votes) {
    const auto at = [&](std::size_t i) { return points[static_cast<std::size_t>(tet[i])]; };
    for (std::size_t place = 0; place < 6; ++place) {
        std::size_t nearest = 0;
        double least = -1;
        for (std::size_t e = 0; e < 6; ++e) {
            const auto a = static_cast<std::size_t>(edge_corners[e][0]);
            const auto b = static_cast<std::size_t>(edge_corners[e][1]);
            const double away = norm(at(4 + place) - 0.5 * (at(a) + at(b)));
            if (least >= 0 && away >= least) continue;
            nearest = e;
            least = away;
        }
        ++votes[place][nearest];
    }
}

}  // namespace

Status order_mid_edge_nodes(std::span<const Vec3> points, std::span<TenNodes> tets) {
    constexpr std::size_t voters = 1000;
    Votes votes{};
    for (const TenNodes& tet : tets.first(std::min(voters, tets.size()))) vote(points, tet, votes);
    std::array<std::size_t, 6> edge_of_place{};
    std::array<bool, 6> taken{};
    for (std::size_t place = 0; place < 6; ++place) {
        const auto& row = votes[place];
        edge_of_place[place] = static_cast<std::size_t>(std::max_element(row.begin(), row.end()) - row.begin());
        if (std::exchange(taken[edge_of_place[place]], true))
            return input_error("the mid-edge nodes of its 10-node tetrahedra do not match six distinct edges");
    }
    for (TenNodes& tet : tets) {
        TenNodes ordered = tet;
        for (std::size_t place = 0; place < 6; ++place) ordered[4 + edge_of_place[place]] = tet[4 + place];
        tet = ordered;
    }
    return {};
}

}  // namespace pliant::mesh
