#include "mesh/tet_locator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant::mesh {
namespace {

/// The point of segment, triangle or tet nearest to `p`, as weights of its corners: the nearest point of the interior's
/// plane if its weights are positive, else the best of the faces. Small and exact enough; used near the surface only.
template <std::size_t N>
std::array<double, N> nearest_weights(const std::array<Vec3, N>& corner, const Vec3& p);

template <>
std::array<double, 2> nearest_weights(const std::array<Vec3, 2>& c, const Vec3& p) {
    const Vec3 d = c[1] - c[0];
    const double length2 = dot(d, d);
    const double t = length2 > 0 ? std::clamp(dot(p - c[0], d) / length2, 0.0, 1.0) : 0;
    return {1 - t, t};
}

template <std::size_t N>
Vec3 weighted(const std::array<Vec3, N>& corner, const std::array<double, N>& weight) {
    Vec3 sum;
    for (std::size_t i = 0; i < N; ++i) sum += weight[i] * corner[i];
    return sum;
}

/// Best of the N faces that leave out one corner each.
template <std::size_t N>
std::array<double, N> nearest_on_faces(const std::array<Vec3, N>& corner, const Vec3& p) {
    std::array<double, N> best{};
    double best_distance = std::numeric_limits<double>::infinity();
    for (std::size_t left_out = 0; left_out < N; ++left_out) {
        std::array<Vec3, N - 1> face;
        for (std::size_t i = 0, k = 0; i < N; ++i) {
            if (i != left_out) face[k++] = corner[i];
        }
        const auto weights = nearest_weights<N - 1>(face, p);
        const double distance = norm(weighted(face, weights) - p);
        if (distance >= best_distance) continue;
        best_distance = distance;
        for (std::size_t i = 0, k = 0; i < N; ++i) best[i] = i == left_out ? 0 : weights[k++];
    }
    return best;
}

template <>
std::array<double, 3> nearest_weights(const std::array<Vec3, 3>& c, const Vec3& p) {
    const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
    const double area2 = dot(n, n);
    if (area2 > 0) {
        const double w1 = dot(cross(p - c[0], c[2] - c[0]), n) / area2;
        const double w2 = dot(cross(c[1] - c[0], p - c[0]), n) / area2;
        if (w1 >= 0 && w2 >= 0 && w1 + w2 <= 1) return {1 - w1 - w2, w1, w2};
    }
    return nearest_on_faces(c, p);
}

template <>
std::array<double, 4> nearest_weights(const std::array<Vec3, 4>& c, const Vec3& p) {
    const double volume = signed_tet_volume(c[0], c[1], c[2], c[3]);
    if (volume != 0) {
        std::array<double, 4> w{};
        for (std::size_t i = 0; i < 4; ++i) {
            auto moved = c;
            moved[i] = p;
            w[i] = signed_tet_volume(moved[0], moved[1], moved[2], moved[3]) / volume;
        }
        if (std::all_of(w.begin(), w.end(), [](double x) { return x >= 0; })) return w;
    }
    return nearest_on_faces(c, p);
}

}  // namespace

TetLocator::TetLocator(const TetMesh& mesh) : mesh_(&mesh) {
    for (const Vec3& p : mesh.points) box_.add(p);
    const Vec3 size = box_.size();
    // About two tets a cell keeps lists short and the grid no larger than the mesh.
    const double volume = std::max(size.x * size.y * size.z, 1e-300);
    cell_size_ = std::max(std::cbrt(2 * volume / static_cast<double>(std::max<std::size_t>(mesh.tet_count(), 1))),
                          1e-9 * box_.diagonal());
    if (!(cell_size_ > 0)) cell_size_ = 1;
    for (std::size_t a = 0; a < 3; ++a) cells_[a] = std::clamp(static_cast<int>(size[a] / cell_size_) + 1, 1, 512);
    cell_size_ = std::max({size.x / cells_[0], size.y / cells_[1], size.z / cells_[2], cell_size_});

    const auto visit = [&](std::size_t t, const auto& act) {
        Box3 box;
        for (std::size_t a = 0; a < 4; ++a) box.add(mesh.points[mesh.tet(t)[a]]);
        const auto low = cell_of(box.low);
        const auto high = cell_of(box.high);
        for (int i = low[0]; i <= high[0]; ++i) {
            for (int j = low[1]; j <= high[1]; ++j) {
                for (int k = low[2]; k <= high[2]; ++k) act(cell_index(i, j, k));
            }
        }
    };
    start_.assign(cell_index(cells_[0] - 1, cells_[1] - 1, cells_[2] - 1) + 2, 0);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) visit(t, [&](std::size_t cell) { ++start_[cell + 1]; });
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    tets_.resize(static_cast<std::size_t>(start_.back()));
    std::vector<int> next(start_.begin(), start_.end() - 1);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        visit(t, [&](std::size_t cell) { tets_[static_cast<std::size_t>(next[cell]++)] = static_cast<int>(t); });
    }
}

std::array<int, 3> TetLocator::cell_of(const Vec3& point) const {
    std::array<int, 3> cell{};
    for (std::size_t a = 0; a < 3; ++a) {
        const double at = (point[a] - box_.low[a]) / cell_size_;
        cell[a] = at >= 0 ? static_cast<int>(std::min(at, cells_[a] - 1.0)) : 0;
    }
    return cell;
}

void TetLocator::try_tet(int tet, const Vec3& point, Location& best) const {
    std::array<Vec3, 4> corner;
    for (std::size_t a = 0; a < 4; ++a) corner[a] = mesh_->points[mesh_->tet(static_cast<std::size_t>(tet))[a]];
    const auto weights = nearest_weights(corner, point);
    const double distance = norm(weighted(corner, weights) - point);
    // Inside, rounding leaves a distance of some 1e-16: both then count as inside and the lower index wins.
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
                    for (int n = start_[cell]; n < start_[cell + 1]; ++n)
                        try_tet(tets_[static_cast<std::size_t>(n)], point, best);
                }
            }
        }
    }
    return best;
}

}  // namespace pliant::mesh
