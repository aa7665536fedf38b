#include "geometry/repair/surface_nesting.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "base/core/boxes.hpp"
#include "geometry/mesh/triangle_tree.hpp"
#include "geometry/repair/surface_shells.hpp"

namespace pliant::mesh {
namespace {

constexpr std::size_t most_nested_shells = 10000;

struct Neighbour {
    int triangle = -1;  ///< -1: the edge does not have exactly two triangles
    bool agrees = true;
};
using Neighbours = std::vector<std::array<Neighbour, 3>>;

/// Counting sort of the sides by their lower ends, then matching within each.
Neighbours neighbours_of(const TriMesh& surface) {
    struct Side {
        int high;
        std::uint32_t index;  ///< three times the triangle, plus the side
        bool forward;
    };
    std::vector<std::uint32_t> ends(surface.points.size() + 1, 0);
    const auto each_side = [&](const auto& take) {
        for (std::size_t i = 0; i < 3 * surface.triangles.size(); ++i)
            take(i, surface.triangles[i / 3][i % 3], surface.triangles[i / 3][(i % 3 + 1) % 3]);
    };
    each_side([&](std::size_t, int a, int b) { ++ends[static_cast<std::size_t>(std::min(a, b)) + 1]; });
    for (std::size_t p = 1; p < ends.size(); ++p) ends[p] += ends[p - 1];
    std::vector<Side> sides(ends.back());
    each_side([&](std::size_t i, int a, int b) {
        sides[ends[static_cast<std::size_t>(std::min(a, b))]++] = {std::max(a, b), static_cast<std::uint32_t>(i),
                                                                   a < b};
    });
    Neighbours neighbours(surface.triangles.size());
    const auto meet = [&](const Side& one, const Side& other) {
        neighbours[one.index / 3][one.index % 3] = {static_cast<int>(other.index / 3), one.forward != other.forward};
    };
    std::uint32_t i = 0;
    for (std::size_t low = 0; low + 1 < ends.size(); ++low) {  // each start was advanced to the end of its sides
        std::sort(sides.begin() + i, sides.begin() + ends[low],
                  [](const Side& a, const Side& b) { return a.high != b.high ? a.high < b.high : a.index < b.index; });
        while (i < ends[low]) {
            std::uint32_t end = i + 1;
            while (end < ends[low] && sides[end].high == sides[i].high) ++end;
            if (end - i == 2 && sides[i].index / 3 != sides[i + 1].index / 3) {
                meet(sides[i], sides[i + 1]);
                meet(sides[i + 1], sides[i]);
            }
            i = end;
        }
    }
    return neighbours;
}

struct NestedShell {
    std::vector<std::size_t> triangles;
    bool closed = true;  ///< and of two sides
    double volume = 0;
    Box3 box;
    std::unique_ptr<TriangleTree> tree;  ///< made on first use
    bool turn = false;
};

/// Orients the shell of a triangle consistently: the smaller part by area is flipped. `side` becomes 1 or -1.
NestedShell walk(TriMesh& surface, const Neighbours& neighbours, std::size_t first, std::vector<std::int8_t>& side,
                 TurnedShells& count) {
    NestedShell shell;
    shell.triangles = {first};
    side[first] = 1;
    for (std::size_t i = 0; i < shell.triangles.size(); ++i) {
        const std::size_t t = shell.triangles[i];
        for (const Neighbour& n : neighbours[t]) {
            if (n.triangle < 0) {
                shell.closed = false;
                continue;
            }
            const auto other = static_cast<std::size_t>(n.triangle);
            const auto wanted = static_cast<std::int8_t>(n.agrees ? side[t] : -side[t]);
            if (side[other] == 0) {
                side[other] = wanted;
                shell.triangles.push_back(other);
            }
            shell.closed = shell.closed && side[other] == wanted;
        }
    }
    if (!shell.closed) return shell;
    double sum = 0;
    for (const std::size_t t : shell.triangles) {
        const auto at = [&](std::size_t k) {
            return surface.points[static_cast<std::size_t>(surface.triangles[t][k])];
        };
        sum += side[t] * norm(cross(at(1) - at(0), at(2) - at(0)));
    }
    const int wrong = sum < 0 ? 1 : -1;
    for (const std::size_t t : shell.triangles) {
        if (side[t] != wrong) continue;
        std::swap(surface.triangles[t][1], surface.triangles[t][2]);
        ++count.triangles;
    }
    return shell;
}

void measure(const TriMesh& surface, NestedShell& shell) {
    const auto at = [&](int corner) { return surface.points[static_cast<std::size_t>(corner)]; };
    const Vec3 origin = at(surface.triangles[shell.triangles.front()][0]);
    for (const std::size_t t : shell.triangles) {
        const auto [a, b, c] = surface.triangles[t];
        for (const int corner : {a, b, c}) shell.box.add(at(corner));
        shell.volume += dot(at(a) - origin, cross(at(b) - origin, at(c) - origin)) / 6;
    }
}

bool lies_in(const Box3& inner, const Box3& outer) {
    return outer.contains(inner.low) && outer.contains(inner.high);
}

class Nesting {
public:
    Nesting(const TriMesh& surface, std::vector<NestedShell>& shells) : surface_(surface), shells_(shells) {}

    /// The number of shells that contain the shell.
    int depth(std::size_t s) {
        int count = 0;
        for (std::size_t o = 0; o < shells_.size(); ++o) {
            if (o == s || !lies_in(shells_[s].box, shells_[o].box)) continue;
            const Vec3 point = tree(s).surface().points.front();
            if (std::fabs(tree(o).winding_number(point)) > 0.5 && !cross(s, o)) ++count;
        }
        return count;
    }
    bool crosses_any(std::size_t s) {
        for (std::size_t o = 0; o < shells_.size(); ++o) {
            if (o != s && boxes_meet(shells_[s].box, shells_[o].box) && cross(s, o)) return true;
        }
        return false;
    }

private:
    const TriangleTree& tree(std::size_t s) {
        NestedShell& shell = shells_[s];
        if (!shell.tree) shell.tree = std::make_unique<TriangleTree>(part_of(surface_, shell.triangles));
        return *shell.tree;
    }
    bool cross(std::size_t a, std::size_t b) {
        // Shells one inside the other, as cubes in cubes, are often far from each other's triangles.
        if (!comes_near(shells_[a], shells_[b].box) || !comes_near(shells_[b], shells_[a].box)) return false;
        return edges_meet(shells_[a], tree(b), shells_[b].box) || edges_meet(shells_[b], tree(a), shells_[a].box);
    }
    /// Whether the box of a triangle comes near another shell's box; else nothing of that one can touch the shell.
    bool comes_near(const NestedShell& shell, const Box3& box) const {
        const double near = 1e-6 * (shell.box.diagonal() + box.diagonal());  // much more than `touching`
        return std::any_of(shell.triangles.begin(), shell.triangles.end(), [&](std::size_t t) {
            Box3 around;
            for (const int corner : surface_.triangles[t])
                around.add(surface_.points[static_cast<std::size_t>(corner)]);
            return boxes_meet(around, box, near);
        });
    }
    /// Whether an edge of a shell meets another one's triangles; touching counts.
    bool edges_meet(const NestedShell& shell, const TriangleTree& other, const Box3& box) const {
        constexpr double touching = 1e-7;  // of the edge
        for (const std::size_t t : shell.triangles) {
            const auto at = [&](std::size_t k) {
                return surface_.points[static_cast<std::size_t>(surface_.triangles[t][k % 3])];
            };
            Box3 around;
            for (std::size_t k = 0; k < 3; ++k) around.add(at(k));
            if (!boxes_meet(around, box)) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 along = at(k + 1) - at(k);
                const auto hit = other.first_hit(at(k), along, -touching);
                if (hit && hit->distance <= 1 + touching) return true;
            }
        }
        return false;
    }

    const TriMesh& surface_;
    std::vector<NestedShell>& shells_;
};

/// Decides from the original shells; none is flipped before all are decided.
void decide(const TriMesh& surface, std::vector<NestedShell>& shells, TurnedShells& count) {
    Nesting nesting(surface, shells);
    for (std::size_t s = 0; s < shells.size(); ++s) {
        const bool cavity = nesting.depth(s) % 2 == 1;
        if (shells[s].volume == 0 || cavity == (shells[s].volume < 0)) continue;
        if (cavity && nesting.crosses_any(s)) continue;
        shells[s].turn = true;
        ++(cavity ? count.cavities : count.inside_out);
    }
}

}  // namespace

TurnedShells orient_by_nesting(TriMesh& surface) {
    TurnedShells count;
    const Neighbours neighbours = neighbours_of(surface);
    std::vector<std::int8_t> side(surface.triangles.size(), 0);
    std::vector<NestedShell> shells;
    for (std::size_t t = 0; t < side.size() && shells.size() < most_nested_shells; ++t) {
        if (side[t] != 0) continue;
        NestedShell shell = walk(surface, neighbours, t, side, count);
        if (!shell.closed) continue;
        measure(surface, shell);
        shells.push_back(std::move(shell));
    }
    decide(surface, shells, count);
    for (const NestedShell& shell : shells) {
        if (!shell.turn) continue;
        for (const std::size_t t : shell.triangles) std::swap(surface.triangles[t][1], surface.triangles[t][2]);
    }
    return count;
}

}  // namespace pliant::mesh
