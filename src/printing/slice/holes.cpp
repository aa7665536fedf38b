#include "printing/slice/holes.hpp"

#include <algorithm>
#include <cmath>

#include "printing/slice/shells.hpp"

namespace pliant::slice {
namespace {

struct RimEdge {
    int from, to;
    bool operator<(const RimEdge& o) const { return from != o.from ? from < o.from : to < o.to; }
};

/// The directed edges without opposite, ordered by their start.
std::vector<RimEdge> missing_edges(const std::vector<Triangle>& triangles) {
    const std::vector<EdgeUse> uses = edge_uses(triangles);
    std::vector<RimEdge> rim;
    for (std::size_t i = 0; i < uses.size();) {
        int surplus = 0;
        std::size_t end = i;
        for (; end < uses.size() && uses[end].a == uses[i].a && uses[end].b == uses[i].b; ++end)
            surplus += uses[end].forward ? 1 : -1;
        for (int n = 0; n < std::abs(surplus); ++n)
            rim.push_back(surplus > 0 ? RimEdge{uses[i].b, uses[i].a} : RimEdge{uses[i].a, uses[i].b});
        i = end;
    }
    std::sort(rim.begin(), rim.end());
    return rim;
}

/// Splits the rim into simple loops of point indices. Every point has as many outgoing as incoming rim edges (the rim
/// is the boundary of a sum of triangles), so a walk can only end where it began.
class RimWalker {
public:
    RimWalker(const std::vector<RimEdge>& rim, std::size_t point_count)
        : rim_(rim), next_(point_count + 1, 0), place_(point_count, -1) {
        for (const RimEdge& e : rim_) ++next_[static_cast<std::size_t>(e.from) + 1];
        for (std::size_t i = 1; i < next_.size(); ++i) next_[i] += next_[i - 1];
        end_.assign(next_.begin() + 1, next_.end());
    }

    std::vector<std::vector<int>> loops() {
        std::vector<std::vector<int>> found;
        for (std::size_t start = 0; start < place_.size(); ++start) {
            while (next_[start] < end_[start]) walk_from(static_cast<int>(start), found);
        }
        return found;
    }

private:
    void walk_from(int start, std::vector<std::vector<int>>& found) {
        std::vector<int> path{start};
        place_[start] = 0;
        while (!path.empty() && next_[path.back()] < end_[path.back()]) {
            const int to = rim_[next_[path.back()]++].to;
            if (place_[to] < 0) {
                place_[to] = static_cast<int>(path.size());
                path.push_back(to);
                continue;
            }
            const auto first = path.begin() + place_[to];
            found.emplace_back(first, path.end());
            for (auto it = first + 1; it != path.end(); ++it) place_[*it] = -1;
            path.erase(first + 1, path.end());
        }
        for (const int p : path) place_[p] = -1;
    }

    const std::vector<RimEdge>& rim_;
    std::vector<std::size_t> next_, end_;  ///< per point: range of outgoing rim edges not walked yet
    std::vector<int> place_;               ///< per point: position in the current path, or -1
};

GridPoint middle(const GridSurface& surface, const std::vector<int>& loop) {
    double x = 0, y = 0, z = 0;
    for (const int p : loop) {
        x += surface.points[p].x;
        y += surface.points[p].y;
        z += surface.points[p].z;
    }
    const auto mean = [&](double sum) {
        return static_cast<std::int32_t>(std::llround(sum / static_cast<double>(loop.size())));
    };
    return {mean(x), mean(y), mean(z)};
}

/// Closes the loop with a fan and returns its area (sum of absolute triangle areas).
double fill(GridSurface& surface, const std::vector<int>& loop) {
    double area2 = 0;
    const auto add = [&](const Triangle& t) {
        surface.triangles.push_back(t);
        area2 += norm(area_vector2(surface, t));
    };
    if (loop.size() == 3) {
        add({loop[0], loop[1], loop[2]});
        return area2 / 2;
    }
    const int centre = static_cast<int>(surface.points.size());
    surface.points.push_back(middle(surface, loop));
    for (std::size_t i = 0; i < loop.size(); ++i) add({loop[i], loop[(i + 1) % loop.size()], centre});
    return area2 / 2;
}

double perimeter(const GridSurface& surface, const std::vector<int>& loop) {
    double length = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const GridPoint &a = surface.points[loop[i]], &b = surface.points[loop[(i + 1) % loop.size()]];
        length += norm(Vec3{double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z});
    }
    return length;
}

void note(Holes& holes, const GridSurface& surface, const std::vector<int>& loop) {
    for (const int p : loop) {
        const std::int32_t z = surface.points[p].z;
        holes.z_low = holes.edges == 0 ? z : std::min(holes.z_low, z);
        holes.z_high = holes.edges == 0 ? z : std::max(holes.z_high, z);
        ++holes.edges;
    }
    ++holes.count;
}

}  // namespace

Holes close_holes(GridSurface& surface) {
    const std::vector<RimEdge> rim = missing_edges(surface.triangles);
    Holes holes;
    for (const std::vector<int>& loop : RimWalker(rim, surface.points.size()).loops()) {
        const double length = perimeter(surface, loop);
        const double area = fill(surface, loop);
        holes.area_mm2 += area * mm2_per_grid2;
        // Mean width of a long crack: area over half the perimeter.
        if (area > 0.5 * length * grid_per_um) note(holes, surface, loop);
    }
    return holes;
}

}  // namespace pliant::slice
