#include "geometry/mesh/tet_locator.hpp"

#include <algorithm>
#include <cmath>

#include "base/core/boxes.hpp"
#include "geometry/mesh/curved_point.hpp"
#include "geometry/mesh/nearest_in_simplex.hpp"

namespace pliant::mesh {

namespace {

/// True if a mid-edge node is off the midpoint of its edge by more than rounding.
bool is_curved(const TetMesh& mesh, std::size_t t, double rounding) {
    const auto n = mesh.tet(t);
    for (std::size_t e = 0; e + 4 < n.size(); ++e) {
        const Vec3 middle = 0.5 * (mesh.points[n[edge_corners[e][0]]] + mesh.points[n[edge_corners[e][1]]]);
        if (norm(mesh.points[n[4 + e]] - middle) > rounding) return true;
    }
    return false;
}

double distance_to(const Box3& box, const Vec3& p) {
    Vec3 off;
    for (std::size_t a = 0; a < 3; ++a) off[a] = std::max({box.low[a] - p[a], p[a] - box.high[a], 0.0});
    return norm(off);
}

}  // namespace

TetLocator::TetLocator(const TetMesh& mesh) : mesh_(&mesh), curved_(mesh.tet_count()) {
    box_ = pliant::bounds_of(mesh.points);
    for (std::size_t t = 0; t < curved_.size(); ++t) curved_[t] = is_curved(mesh, t, 1e-12 * box_.diagonal());
    const Vec3 size = box_.size();
    // About two tets per cell: short lists, and a grid no larger than the mesh.
    const double volume = std::max(size.x * size.y * size.z, 1e-300);
    double wanted = std::max(std::cbrt(2 * volume / static_cast<double>(std::max<std::size_t>(mesh.tet_count(), 1))),
                             1e-9 * box_.diagonal());
    if (!(wanted > 0)) wanted = 1;
    choose_cells(wanted);
    // Long tets across the mesh have boxes of many cells: their number times that of the cells.
    constexpr std::size_t most_per_tet = 64;
    while (cell_count() > 1 && entries() > most_per_tet * mesh.tet_count()) choose_cells(wanted *= 2);

    const auto visit = [&](std::size_t t, const auto& act) {
        const auto [low, high] = cells_of(t);
        for (int i = low[0]; i <= high[0]; ++i) {
            for (int j = low[1]; j <= high[1]; ++j) {
                for (int k = low[2]; k <= high[2]; ++k) act(cell_index(i, j, k));
            }
        }
    };
    start_.assign(cell_count() + 1, 0);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) visit(t, [&](std::size_t cell) { ++start_[cell + 1]; });
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    tets_.resize(start_.back());
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t)
        visit(t, [&](std::size_t cell) { tets_[next[cell]++] = static_cast<int>(t); });
}

void TetLocator::choose_cells(double wanted) {
    const Vec3 size = box_.size();
    for (std::size_t a = 0; a < 3; ++a) cells_[a] = static_cast<int>(std::clamp(size[a] / wanted + 1, 1.0, 512.0));
    cell_size_ = std::max({size.x / cells_[0], size.y / cells_[1], size.z / cells_[2], wanted});
}

std::size_t TetLocator::entries() const {
    std::size_t sum = 0;
    for (std::size_t t = 0; t < mesh_->tet_count(); ++t) {
        const auto [low, high] = cells_of(t);
        std::size_t cells = 1;
        for (std::size_t a = 0; a < 3; ++a) cells *= static_cast<std::size_t>(high[a] - low[a] + 1);
        sum += cells;
    }
    return sum;
}

std::pair<TetLocator::Cell, TetLocator::Cell> TetLocator::cells_of(std::size_t tet) const {
    const Box3 box = bounds_of(tet);
    return {cell_of(box.low), cell_of(box.high)};
}

TetLocator::Cell TetLocator::cell_of(const Vec3& point) const {
    Cell cell{};
    for (std::size_t a = 0; a < 3; ++a) {
        const double at = (point[a] - box_.low[a]) / cell_size_;
        cell[a] = at >= 0 ? static_cast<int>(std::min(at, cells_[a] - 1.0)) : 0;
    }
    return cell;
}

Box3 TetLocator::bounds_of(std::size_t tet) const {
    if (curved_[tet]) return curved_bounds(nodes_of(*mesh_, tet));
    Box3 box;
    for (std::size_t a = 0; a < 4; ++a) box.add(mesh_->points[mesh_->tet(tet)[a]]);
    return box;
}

void TetLocator::try_tet(int tet, const Vec3& point, Location& best) const {
    const auto t = static_cast<std::size_t>(tet);
    std::array<double, 4> weights{};
    double distance = 0;
    if (curved_[t]) {
        const TetNodes nodes = nodes_of(*mesh_, t);
        if (best.tet >= 0 && distance_to(curved_bounds(nodes), point) > best.distance) return;
        const CurvedPoint found = nearest_in_curved_tet(nodes, point);
        weights = found.barycentric;
        distance = found.distance;
    } else {
        std::array<Vec3, 4> corner;
        for (std::size_t a = 0; a < 4; ++a) corner[a] = mesh_->points[mesh_->tet(t)[a]];
        weights = nearest_weights(corner, point);
        distance = norm(weighted(corner, weights) - point);
    }
    // For points inside, rounding leaves a distance of about 1e-16: both tets then count as containing it and the lower
    // index wins.
    const double exact = 1e-12 * box_.diagonal();
    const double counted = distance <= exact ? 0 : distance;
    if (best.tet < 0 || counted < best.distance || (counted == best.distance && tet < best.tet))
        best = {tet, weights, counted};
}

TetLocator::Location TetLocator::locate(const Vec3& point) const {
    Location best;
    const auto home = cell_of(point);
    const int farthest = std::max({cells_[0], cells_[1], cells_[2]});
    for (int ring = 0; ring <= farthest; ++ring) {
        // Cells of this ring are at least (ring - 1) cells from the nearest point of the grid to the query.
        if (best.tet >= 0 && best.distance <= (ring - 1) * cell_size_) break;
        for (int i = std::max(home[0] - ring, 0); i <= std::min(home[0] + ring, cells_[0] - 1); ++i) {
            for (int j = std::max(home[1] - ring, 0); j <= std::min(home[1] + ring, cells_[1] - 1); ++j) {
                for (int k = std::max(home[2] - ring, 0); k <= std::min(home[2] + ring, cells_[2] - 1); ++k) {
                    const bool on_ring =
                        std::max({std::abs(i - home[0]), std::abs(j - home[1]), std::abs(k - home[2])}) == ring;
                    if (!on_ring) continue;
                    const std::size_t cell = cell_index(i, j, k);
                    for (std::size_t n = start_[cell]; n < start_[cell + 1]; ++n) try_tet(tets_[n], point, best);
                }
            }
        }
    }
    return best;
}

}  // namespace pliant::mesh
