#include "printing/slice/shells.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace pliant::slice {
namespace {

/// The triangle across each edge, or -1 if the edge is not shared by exactly two; `agrees` if both run along it in
/// opposite directions, as consistently oriented neighbours do.
struct EdgeNeighbour {
    int triangle = -1;
    bool agrees = true;
};
using Neighbours = std::vector<std::array<EdgeNeighbour, 3>>;

int free_slot(const std::array<EdgeNeighbour, 3>& slots) {
    return slots[0].triangle < 0 ? 0 : (slots[1].triangle < 0 ? 1 : 2);
}

Neighbours find_neighbours(std::size_t triangles, const std::vector<EdgeUse>& uses) {
    Neighbours neighbours(triangles);
    for (std::size_t i = 0; i < uses.size();) {
        std::size_t end = i + 1;
        while (end < uses.size() && uses[end].a == uses[i].a && uses[end].b == uses[i].b) ++end;
        if (end - i == 2 && uses[i].triangle != uses[i + 1].triangle) {
            const bool agrees = uses[i].forward != uses[i + 1].forward;
            for (const auto& [from, to] : {std::pair{i, i + 1}, std::pair{i + 1, i}}) {
                auto& slots = neighbours[uses[from].triangle];
                slots[free_slot(slots)] = {uses[to].triangle, agrees};
            }
        }
        i = end;
    }
    return neighbours;
}

struct Walk {
    Shells shells;
    std::vector<std::uint8_t> turned;  ///< (m) relative to the first triangle of the component
};

Walk walk_pieces(std::size_t count, const Neighbours& neighbours) {
    Walk walk{{0, std::vector<int>(count, -1)}, std::vector<std::uint8_t>(count, 0)};
    std::vector<int> open;
    for (std::size_t first = 0; first < count; ++first) {
        if (walk.shells.of_triangle[first] >= 0) continue;
        const int shell = walk.shells.count++;
        walk.shells.of_triangle[first] = shell;
        open.push_back(static_cast<int>(first));
        while (!open.empty()) {
            const int t = open.back();
            open.pop_back();
            for (const EdgeNeighbour& n : neighbours[t]) {
                if (n.triangle < 0 || walk.shells.of_triangle[n.triangle] >= 0) continue;
                walk.shells.of_triangle[n.triangle] = shell;
                walk.turned[n.triangle] = static_cast<std::uint8_t>(walk.turned[t] ^ (n.agrees ? 0 : 1));
                open.push_back(n.triangle);
            }
        }
    }
    return walk;
}

struct ShellExtent {
    double volume6 = 0;
    std::array<std::int32_t, 3> low{INT32_MAX, INT32_MAX, INT32_MAX};
    std::array<std::int32_t, 3> high{INT32_MIN, INT32_MIN, INT32_MIN};

    void add(const GridPoint& p) {
        const std::array<std::int32_t, 3> xyz{p.x, p.y, p.z};
        for (std::size_t i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], xyz[i]);
            high[i] = std::max(high[i], xyz[i]);
        }
    }
    [[nodiscard]] bool inside(const ShellExtent& other) const {
        for (std::size_t i = 0; i < 3; ++i) {
            if (low[i] < other.low[i] || high[i] > other.high[i]) return false;
        }
        return true;
    }
};

std::vector<ShellExtent> measure(const GridSurface& surface, const Shells& shells) {
    std::vector<ShellExtent> pieces(static_cast<std::size_t>(shells.count));
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        ShellExtent& piece = pieces[shells.of_triangle[t]];
        piece.volume6 += signed_volume6(surface, surface.triangles[t]);
        for (const int corner : surface.triangles[t]) piece.add(surface.points[corner]);
    }
    return pieces;
}

bool is_cavity(const std::vector<ShellExtent>& pieces, const ShellExtent& piece) {
    return std::any_of(pieces.begin(), pieces.end(),
                       [&](const ShellExtent& other) { return other.volume6 > 0 && piece.inside(other); });
}

}  // namespace

/// Counting sort by the smaller ends, then within each: an end has only a few edges.
std::vector<EdgeUse> edge_uses(const std::vector<Triangle>& triangles) {
    int points = 0;
    for (const Triangle& t : triangles) points = std::max({points, t[0] + 1, t[1] + 1, t[2] + 1});
    std::vector<std::uint32_t> ends(static_cast<std::size_t>(points) + 1, 0);
    const auto each = [&](const auto& visit) {
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) visit(t, triangles[t][i], triangles[t][(i + 1) % 3]);
        }
    };
    each([&](std::size_t, int from, int to) { ++ends[static_cast<std::size_t>(std::min(from, to)) + 1]; });
    for (std::size_t p = 1; p < ends.size(); ++p) ends[p] += ends[p - 1];
    std::vector<EdgeUse> uses(3 * triangles.size());
    each([&](std::size_t t, int from, int to) {
        const int a = std::min(from, to);
        uses[ends[a]++] = {a, std::max(from, to), static_cast<int>(t), from < to};
    });
    std::uint32_t begin = 0;
    for (int p = 0; p < points; ++p) {  // each start was advanced to the end of its uses
        std::sort(uses.begin() + begin, uses.begin() + ends[p],
                  [](const EdgeUse& l, const EdgeUse& r) { return l.b != r.b ? l.b < r.b : l.triangle < r.triangle; });
        begin = ends[p];
    }
    return uses;
}

bool all_paired(const std::vector<EdgeUse>& uses) {
    const auto same = [&](std::size_t i, std::size_t j) { return uses[i].a == uses[j].a && uses[i].b == uses[j].b; };
    for (std::size_t i = 0; i < uses.size(); i += 2) {
        if (i + 1 == uses.size() || !same(i, i + 1) || uses[i].forward == uses[i + 1].forward) return false;
        if (i + 2 < uses.size() && same(i, i + 2)) return false;
    }
    return true;
}

int orient_consistently(GridSurface& surface) {
    const std::size_t count = surface.triangles.size();
    const Walk walk = walk_pieces(count, find_neighbours(count, edge_uses(surface.triangles)));
    std::vector<double> turned_area(static_cast<std::size_t>(walk.shells.count), 0.0);
    for (std::size_t t = 0; t < count; ++t) {
        const double area = norm(area_vector2(surface, surface.triangles[t]));
        turned_area[walk.shells.of_triangle[t]] += walk.turned[t] ? area : -area;
    }
    int turned = 0;
    for (std::size_t t = 0; t < count; ++t) {
        const bool majority_turned = turned_area[walk.shells.of_triangle[t]] > 0;
        if ((walk.turned[t] != 0) == majority_turned) continue;
        std::swap(surface.triangles[t][1], surface.triangles[t][2]);
        ++turned;
    }
    return turned;
}

Shells find_shells(const GridSurface& surface, const std::vector<EdgeUse>& uses) {
    const std::size_t count = surface.triangles.size();
    return walk_pieces(count, find_neighbours(count, uses)).shells;
}

int turn_inverted_shells(GridSurface& surface, const std::vector<EdgeUse>& uses) {
    const Shells shells = find_shells(surface, uses);
    std::vector<ShellExtent> pieces = measure(surface, shells);
    double total = 0;
    for (const ShellExtent& piece : pieces) total += piece.volume6;
    const double sign = total < 0 ? -1 : 1;
    for (ShellExtent& piece : pieces) piece.volume6 *= sign;
    std::vector<std::uint8_t> turn(pieces.size(), 0);
    for (std::size_t s = 0; s < pieces.size(); ++s) {
        const bool alone_inverted = pieces[s].volume6 < 0 && !is_cavity(pieces, pieces[s]);
        turn[s] = (sign < 0) != alone_inverted;
    }
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (turn[shells.of_triangle[t]]) std::swap(surface.triangles[t][1], surface.triangles[t][2]);
    }
    return static_cast<int>(std::count(turn.begin(), turn.end(), 1));
}

}  // namespace pliant::slice
