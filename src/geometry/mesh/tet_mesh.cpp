#include "geometry/mesh/tet_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <numeric>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "base/core/parallel.hpp"

namespace pliant::mesh {
namespace {

std::array<int, 3> sorted(std::array<int, 3> corners) {
    std::sort(corners.begin(), corners.end());
    return corners;
}

/// The mid-edge slot (0 to 5) between two corner slots.
int edge_slot(int a, int b) {
    for (int e = 0; e < 6; ++e) {
        const auto& [p, q] = edge_corners[static_cast<std::size_t>(e)];
        if ((p == a && q == b) || (p == b && q == a)) return e;
    }
    return -1;
}

Face face_of(const TetMesh& mesh, std::size_t t, int f) {
    const auto tet = mesh.tet(t);
    const auto& corners = face_corners[static_cast<std::size_t>(f)];
    Face face{{-1, -1, -1, -1, -1, -1}, static_cast<int>(t)};
    for (int i = 0; i < 3; ++i) {
        face.nodes[i] = tet[corners[i]];
        if (mesh.order == 2) face.nodes[3 + i] = tet[4 + edge_slot(corners[i], corners[(i + 1) % 3])];
    }
    return face;
}

/// A face in the list of its smallest corner: the other two corners, ascending, and 4 times its tet plus its slot.
struct Listed {
    int middle, largest;
    std::uint32_t face;
    [[nodiscard]] bool is_on_same(const Listed& other) const {
        return middle == other.middle && largest == other.largest;
    }
};

/// Faces of the tets for which `member` holds, grouped by smallest corner: `start` (points + 1) says where each group
/// begins.
template <class Member>
std::vector<Listed> by_smallest_corner(const TetMesh& mesh, const Member& member, std::vector<std::size_t>& start) {
    const auto visit = [&](const auto& use) {
        for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
            if (!member(t)) continue;
            const auto tet = mesh.tet(t);
            for (std::size_t f = 0; f < 4; ++f) {
                const auto& c = face_corners[f];
                const auto [a, b, d] = sorted({tet[c[0]], tet[c[1]], tet[c[2]]});
                use(static_cast<std::size_t>(a), Listed{b, d, static_cast<std::uint32_t>(4 * t + f)});
            }
        }
    };
    start.assign(mesh.points.size() + 1, 0);
    visit([&](std::size_t corner, const Listed&) { ++start[corner + 1]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<Listed> faces(start.back());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    visit([&](std::size_t corner, const Listed& face) { faces[next[corner]++] = face; });
    return faces;
}

/// Calls `use` with the faces of each group of by_smallest_corner(), equal ones side by side; on several threads.
template <class Member, class Use>
void for_each_group(const TetMesh& mesh, const Member& member, const Use& use) {
    constexpr std::size_t corners_at_once = 1024;
    std::vector<std::size_t> start;
    std::vector<Listed> listed = by_smallest_corner(mesh, member, start);
    parallel_for(mesh.points.size(), corners_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t corner = begin; corner < end; ++corner) {
            const auto list = std::span(listed).subspan(start[corner], start[corner + 1] - start[corner]);
            std::sort(list.begin(), list.end(), [](const Listed& a, const Listed& b) {
                return std::tie(a.middle, a.largest, a.face) < std::tie(b.middle, b.largest, b.face);
            });
            use(std::span<const Listed>(list));
        }
    });
}

/// Faces that belong to only one of the tets for which `member` holds.
template <class Member>
std::vector<Face> single_faces(const TetMesh& mesh, const Member& member) {
    std::vector<char> single(4 * mesh.tet_count(), 0);
    for_each_group(mesh, member, [&](std::span<const Listed> list) {
        for (std::size_t k = 0; k < list.size(); ++k) {
            const bool alone = (k == 0 || !list[k].is_on_same(list[k - 1])) &&
                               (k + 1 == list.size() || !list[k].is_on_same(list[k + 1]));
            single[list[k].face] = alone ? 1 : 0;
        }
    });
    std::vector<Face> faces;
    for (std::size_t k = 0; k < single.size(); ++k) {
        if (single[k] != 0) faces.push_back(face_of(mesh, k / 4, static_cast<int>(k % 4)));
    }
    return faces;
}

/// Whether the corners of a face ascend when seen from outside its tet, beginning with the smallest.
bool ascends(const TetMesh& mesh, std::uint32_t face) {
    const auto n = mesh.tet(face / 4);
    const auto& c = face_corners[face % 4];
    std::array<int, 3> corners{n[c[0]], n[c[1]], n[c[2]]};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    return corners[1] < corners[2];
}

template <class Member>
double volume_where(const TetMesh& mesh, const Member& member) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (!member(t)) continue;
        const auto n = mesh.tet(t);
        sum += signed_tet_volume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]);
    }
    return sum;
}

}  // namespace

void reverse_tet(std::span<int> nodes) {
    std::swap(nodes[1], nodes[2]);
    if (nodes.size() < 10) return;
    std::swap(nodes[4], nodes[6]);  // edges 01-02 and 13-23 swap with corners 1 and 2
    std::swap(nodes[8], nodes[9]);
}

double signed_tet_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return dot(b - a, cross(c - a, d - a)) / 6;
}

double volume(const TetMesh& mesh) {
    return volume_where(mesh, [](std::size_t) { return true; });
}

double volume(const TetMesh& mesh, int region) {
    return volume_where(mesh, [&](std::size_t t) { return mesh.region[t] == region; });
}

std::vector<Face> boundary_faces(const TetMesh& mesh) {
    return single_faces(mesh, [](std::size_t) { return true; });
}

std::vector<Face> region_faces(const TetMesh& mesh, int region) {
    return single_faces(mesh, [&](std::size_t t) { return mesh.region[t] == region; });
}

std::optional<OverlappingTets> overlapping_tets(const TetMesh& mesh) {
    std::mutex mutex;
    std::optional<OverlappingTets> lowest;
    const auto order = [](const OverlappingTets& pair) { return std::tuple(!pair.same, pair.first, pair.second); };
    const auto all = [](std::size_t) { return true; };
    const auto take = [&](const Listed& one, const Listed& other, bool same) {
        const OverlappingTets pair{static_cast<int>(one.face / 4), static_cast<int>(other.face / 4), same};
        const std::lock_guard lock(mutex);
        if (!lowest || order(pair) < order(*lowest)) lowest = pair;
    };
    for_each_group(mesh, all, [&](std::span<const Listed> list) {
        std::vector<Listed> side;
        const auto apex = [&](const Listed& l) { return mesh.tet(l.face / 4)[l.face % 4]; };
        for (std::size_t begin = 0, end = 0; begin < list.size(); begin = end) {
            while (end < list.size() && list[end].is_on_same(list[begin])) ++end;
            for (const bool up : {false, true}) {
                side.clear();
                for (std::size_t k = begin; k < end; ++k)
                    if (ascends(mesh, list[k].face) == up) side.push_back(list[k]);
                if (side.size() < 2) continue;
                // Only the lowest pairs: a file may repeat a tet any number of times.
                take(side[0], side[1], apex(side[0]) == apex(side[1]));
                std::stable_sort(side.begin(), side.end(),
                                 [&](const Listed& a, const Listed& b) { return apex(a) < apex(b); });
                for (std::size_t k = 1; k < side.size(); ++k) {
                    const bool second = k < 2 || apex(side[k - 2]) != apex(side[k]);
                    if (second && apex(side[k - 1]) == apex(side[k])) take(side[k - 1], side[k], true);
                }
            }
        }
    });
    return lowest;
}

std::string overlap_text(const OverlappingTets& pair) {
    return fmt::format(fmt::runtime(pair.same ? "tetrahedra {} and {} are the same"
                                              : "tetrahedra {} and {} overlap: they lie on the same side of a face "
                                                "that they share"),
                       pair.first, pair.second);
}

Extract extract_regions(const TetMesh& mesh, const std::vector<bool>& keep) {
    Extract extract;
    extract.mesh.order = mesh.order;
    extract.node.assign(mesh.points.size(), -1);
    std::vector<int> new_region(keep.size(), -1);
    for (std::size_t r = 0; r < keep.size(); ++r) {
        if (!keep[r]) continue;
        new_region[r] = static_cast<int>(extract.mesh.region_names.size());
        extract.mesh.region_names.push_back(mesh.region_names[r]);
    }
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const int region = new_region[static_cast<std::size_t>(mesh.region[t])];
        if (region < 0) continue;
        extract.mesh.region.push_back(region);
        for (const int node : mesh.tet(t)) extract.node[static_cast<std::size_t>(node)] = 0;
    }
    for (std::size_t n = 0; n < mesh.points.size(); ++n) {
        if (extract.node[n] < 0) continue;
        extract.node[n] = static_cast<int>(extract.mesh.points.size());
        extract.mesh.points.push_back(mesh.points[n]);
    }
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (new_region[static_cast<std::size_t>(mesh.region[t])] < 0) continue;
        for (const int node : mesh.tet(t)) extract.mesh.nodes.push_back(extract.node[static_cast<std::size_t>(node)]);
    }
    return extract;
}

TriMesh region_surface(const TetMesh& mesh, int region) {
    const auto faces = region_faces(mesh, region);
    TriMesh surface;
    std::vector<int> index(mesh.points.size(), -1);
    const auto point = [&](int node) {
        if (index[node] < 0) {
            index[node] = static_cast<int>(surface.points.size());
            surface.points.push_back(mesh.points[node]);
        }
        return index[node];
    };
    for (const Face& face : faces) {
        std::array<int, 6> n{};
        for (std::size_t i = 0; i < (mesh.order == 2 ? 6u : 3u); ++i) n[i] = point(face.nodes[i]);
        if (mesh.order == 2) {
            surface.triangles.insert(surface.triangles.end(),
                                     {{n[0], n[3], n[5]}, {n[3], n[1], n[4]}, {n[5], n[4], n[2]}, {n[3], n[4], n[5]}});
        } else {
            surface.triangles.push_back({n[0], n[1], n[2]});
        }
    }
    return surface;
}

TetMesh to_quadratic(const TetMesh& mesh) {
    if (mesh.order == 2) return mesh;
    TetMesh quadratic;
    quadratic.order = 2;
    quadratic.points = mesh.points;
    quadratic.region = mesh.region;
    quadratic.region_names = mesh.region_names;
    quadratic.notes = mesh.notes;
    quadratic.nodes.reserve(mesh.tet_count() * 10);
    std::unordered_map<std::uint64_t, int> middle;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const auto tet = mesh.tet(t);
        quadratic.nodes.insert(quadratic.nodes.end(), tet.begin(), tet.end());
        for (const auto& [p, q] : edge_corners) {
            const auto a = static_cast<std::uint32_t>(std::min(tet[p], tet[q]));
            const auto b = static_cast<std::uint32_t>(std::max(tet[p], tet[q]));
            const auto [entry, fresh] =
                middle.try_emplace((std::uint64_t{a} << 32) | b, static_cast<int>(quadratic.points.size()));
            if (fresh) quadratic.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));
            quadratic.nodes.push_back(entry->second);
        }
    }
    return quadratic;
}

TetMesh scaled(TetMesh mesh, double factor) {
    for (Vec3& p : mesh.points) p *= factor;
    return mesh;
}

std::vector<double> shape_functions(int order, const std::array<double, 4>& b) {
    if (order == 1) return {b[0], b[1], b[2], b[3]};
    std::vector<double> weights(10);
    for (std::size_t i = 0; i < 4; ++i) weights[i] = b[i] * (2 * b[i] - 1);
    for (std::size_t e = 0; e < 6; ++e) weights[4 + e] = 4 * b[edge_corners[e][0]] * b[edge_corners[e][1]];
    return weights;
}

}  // namespace pliant::mesh
