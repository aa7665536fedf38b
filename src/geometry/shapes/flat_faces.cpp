#include "geometry/shapes/flat_faces.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "geometry/mesh/triangle_tree.hpp"
#include "geometry/repair/surface_check.hpp"
#include "geometry/repair/surface_shells.hpp"
#include "geometry/repair/surface_slivers.hpp"

namespace pliant::mesh {
namespace {

constexpr double flat_share = 1e-6;    // of the surface's size: points within this distance of a plane count as in it
constexpr double exact_share = 1e-10;  // well within what Open CASCADE accepts as flat

struct Plane {
    Vec3 normal;  ///< of length 1
    double offset = 0;
    [[nodiscard]] double distance(const Vec3& p) const { return dot(normal, p) - offset; }
};

/// One piece of the surface, its triangles grouped by plane.
class Faceting {
public:
    explicit Faceting(const TriMesh& surface) : surface_(surface), group_(surface.triangles.size(), -1) {
        size_ = bounds(surface).diagonal();
        link();
        std::vector<std::size_t> order(surface.triangles.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return norm(area_normal(a)) > norm(area_normal(b)); });
        for (const std::size_t t : order) {
            if (group_[t] < 0) grow(t);
        }
    }

    /// The polygons by shell, outer shell first; `points` are moved onto their planes.
    FacetedSurface::Piece piece(std::vector<Vec3>& points) {
        fit_planes();
        move_points(points);
        std::vector<std::vector<std::size_t>> members(planes_.size());
        for (std::size_t t = 0; t < group_.size(); ++t) members[static_cast<std::size_t>(group_[t])].push_back(t);
        std::map<int, FacetedSurface::Shell> shells;
        for (std::size_t g = 0; g < members.size(); ++g) {
            FacetedSurface::Shell& shell = shells[shell_[members[g].front()]];
            FacetedSurface::Face face = outline(members[g], planes_[g], points);
            if (!face.empty()) {
                shell.push_back(std::move(face));
                continue;
            }
            for (const std::size_t t : members[g]) {  // not flat enough, or self-touching: keep its triangles
                const auto& [a, b, c] = surface_.triangles[t];
                shell.push_back({{a, b, c}});
            }
        }
        FacetedSurface::Piece result;
        for (auto& [number, shell] : shells) {
            result.push_back(std::move(shell));
            if (volume_of_shell(number) > 0) std::swap(result.front(), result.back());
        }
        return result;
    }

private:
    [[nodiscard]] const Vec3& at(int n) const { return surface_.points[static_cast<std::size_t>(n)]; }
    [[nodiscard]] Vec3 area_normal(std::size_t t) const {
        const auto& [a, b, c] = surface_.triangles[t];
        return 0.5 * cross(at(b) - at(a), at(c) - at(a));
    }

    /// Neighbours across edges, and the shell of each triangle.
    void link() {
        std::map<std::pair<int, int>, std::size_t> of_edge;
        for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k)
                of_edge[{surface_.triangles[t][k], surface_.triangles[t][(k + 1) % 3]}] = t;
        }
        neighbours_.resize(surface_.triangles.size());
        for (const auto& [edge, t] : of_edge) {
            const auto other = of_edge.find({edge.second, edge.first});
            if (other != of_edge.end()) neighbours_[t].push_back(other->second);
        }
        shell_.resize(surface_.triangles.size());
        const auto shells = shell_triangles(surface_);
        for (std::size_t s = 0; s < shells.size(); ++s) {
            for (const std::size_t t : shells[s]) shell_[t] = static_cast<int>(s);
        }
    }

    void grow(std::size_t seed) {
        const Vec3 normal = area_normal(seed) / norm(area_normal(seed));
        const Plane plane{normal, dot(normal, at(surface_.triangles[seed][0]))};
        const int group = static_cast<int>(planes_.size());
        planes_.push_back(plane);
        std::vector<std::size_t> open = {seed};
        group_[seed] = group;
        while (!open.empty()) {
            const std::size_t t = open.back();
            open.pop_back();
            for (const std::size_t other : neighbours_[t]) {
                const auto& corners = surface_.triangles[other];
                if (group_[other] >= 0 || dot(area_normal(other), normal) <= 0) continue;
                if (std::any_of(corners.begin(), corners.end(),
                                [&](int n) { return std::fabs(plane.distance(at(n))) > flat_share * size_; }))
                    continue;
                group_[other] = group;
                open.push_back(other);
            }
        }
    }

    /// Fits planes to all triangles of each group, not only to its largest one.
    void fit_planes() {
        std::vector<Vec3> normal(planes_.size());
        std::vector<double> area(planes_.size(), 0);
        std::vector<Vec3> middle(planes_.size());
        for (std::size_t t = 0; t < group_.size(); ++t) {
            const auto g = static_cast<std::size_t>(group_[t]);
            const auto& [a, b, c] = surface_.triangles[t];
            const double one = norm(area_normal(t));
            normal[g] += area_normal(t);
            middle[g] += one / 3 * (at(a) + at(b) + at(c));
            area[g] += one;
        }
        for (std::size_t g = 0; g < planes_.size(); ++g) {
            planes_[g].normal = normal[g] / norm(normal[g]);
            planes_[g].offset = dot(planes_[g].normal, middle[g] / area[g]);
        }
    }

    /// Moves each point to the intersection of its planes, by projection onto one after the other.
    void move_points(std::vector<Vec3>& points) {
        std::vector<std::set<int>> around(surface_.points.size());
        for (std::size_t t = 0; t < group_.size(); ++t) {
            for (const int n : surface_.triangles[t]) around[static_cast<std::size_t>(n)].insert(group_[t]);
        }
        points = surface_.points;
        for (std::size_t n = 0; n < points.size(); ++n) {
            Vec3 p = points[n];
            for (int round = 0; round < 60; ++round) {
                for (const int g : around[n]) {
                    const Plane& plane = planes_[static_cast<std::size_t>(g)];
                    p -= plane.distance(p) * plane.normal;
                }
            }
            if (norm(p - points[n]) < 10 * flat_share * size_) points[n] = p;
        }
    }

    /// The loops around a group of triangles, the outer one first; empty if they do not form a single face.
    [[nodiscard]] FacetedSurface::Face outline(const std::vector<std::size_t>& triangles, const Plane& plane,
                                               const std::vector<Vec3>& points) const {
        std::map<int, int> next;
        for (const std::size_t t : triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                const int a = surface_.triangles[t][k];
                const int b = surface_.triangles[t][(k + 1) % 3];
                const bool inner = std::any_of(neighbours_[t].begin(), neighbours_[t].end(), [&](std::size_t other) {
                    const auto& c = surface_.triangles[other];
                    const auto at_b = std::find(c.begin(), c.end(), b);
                    return group_[other] == group_[t] && at_b != c.end() &&
                           c[static_cast<std::size_t>(at_b - c.begin() + 1) % 3] == a;
                });
                if (inner) continue;
                if (!next.try_emplace(a, b).second) return {};
                if (std::fabs(plane.distance(points[static_cast<std::size_t>(a)])) > exact_share * size_) return {};
            }
        }
        FacetedSurface::Face loops;
        double largest = 0;
        while (!next.empty()) {
            FacetedSurface::Loop loop;
            Vec3 twice_area;
            for (auto edge = next.begin(); edge != next.end(); edge = next.find(loop.back())) {
                const int to = edge->second;
                twice_area +=
                    cross(points[static_cast<std::size_t>(edge->first)], points[static_cast<std::size_t>(to)]);
                next.erase(edge);
                loop.push_back(to);
            }
            loops.push_back(std::move(loop));
            const double area = dot(twice_area, plane.normal);
            if (area > largest) {
                largest = area;
                std::swap(loops.front(), loops.back());
            }
        }
        return loops;
    }

    [[nodiscard]] double volume_of_shell(int shell) const {
        double six = 0;
        for (std::size_t t = 0; t < shell_.size(); ++t) {
            const auto& [a, b, c] = surface_.triangles[t];
            if (shell_[t] == shell) six += dot(at(a), cross(at(b), at(c)));
        }
        return six;
    }

    const TriMesh& surface_;
    double size_ = 0;
    std::vector<std::vector<std::size_t>> neighbours_;
    std::vector<int> shell_;  ///< (triangles)
    std::vector<int> group_;  ///< (triangles)
    std::vector<Plane> planes_;
};

/// Twice its area times its normal, by its outline.
Vec3 area_normal(const FacetedSurface::Loop& loop, const std::vector<Vec3>& points) {
    Vec3 sum;
    const Vec3& from = points[static_cast<std::size_t>(loop.front())];
    for (std::size_t k = 1; k + 1 < loop.size(); ++k)
        sum += cross(points[static_cast<std::size_t>(loop[k])] - from,
                     points[static_cast<std::size_t>(loop[k + 1])] - from);
    return sum;
}

/// The number of faces with a neighbour at less than 30 degrees: typical of a round surface cut into strips.
std::size_t smooth_faces(const FacetedSurface& faceted) {
    constexpr double cosine = 0.8660254037844387;
    constexpr double flat = 1 - 1e-9;  // faces of several loops may be kept as triangles of one plane
    std::map<std::pair<int, int>, std::size_t> face_of_edge;
    std::vector<Vec3> normals;
    for (const FacetedSurface::Piece& piece : faceted.pieces) {
        for (const FacetedSurface::Shell& shell : piece) {
            for (const FacetedSurface::Face& face : shell) {
                for (const FacetedSurface::Loop& loop : face) {
                    for (std::size_t k = 0; k < loop.size(); ++k)
                        face_of_edge[{loop[k], loop[(k + 1) % loop.size()]}] = normals.size();
                }
                const Vec3 normal = area_normal(face.front(), faceted.points);
                normals.push_back(unit(normal));
            }
        }
    }
    std::set<std::size_t> smooth;
    for (const auto& [edge, face] : face_of_edge) {
        const auto other = face_of_edge.find({edge.second, edge.first});
        if (other == face_of_edge.end()) continue;
        const double turn = dot(normals[face], normals[other->second]);
        if (turn > cosine && turn < flat) smooth.insert(face);
    }
    return smooth.size();
}

}  // namespace

Result<FacetedSurface> flat_faces(const TriMesh& surface, std::size_t most) {
    if (Status status = check_closed(surface); !status) return tl::unexpected(status.error());
    const Result<std::vector<TriMesh>> pieces = solid_pieces(surface);
    if (!pieces) return tl::unexpected(pieces.error());
    FacetedSurface faceted;
    std::size_t faces = 0;
    for (const TriMesh& one : *pieces) {
        std::vector<Vec3> points;
        FacetedSurface::Piece piece = Faceting(one).piece(points);
        const int offset = static_cast<int>(faceted.points.size());
        for (FacetedSurface::Shell& shell : piece) {
            faces += shell.size();
            for (FacetedSurface::Face& face : shell) {
                for (FacetedSurface::Loop& loop : face) {
                    for (int& n : loop) n += offset;
                }
            }
        }
        faceted.points.insert(faceted.points.end(), points.begin(), points.end());
        faceted.pieces.push_back(std::move(piece));
    }
    if (faces > most)
        return input_error("its surface has {} flat faces; up to {} can be joined to what they touch", faces, most);
    return faceted;
}

Result<Solid> polyhedron(const TriMesh& surface) {
    constexpr std::size_t most = 400;        // this many take Open CASCADE half a minute
    constexpr std::size_t most_smooth = 40;  // more mean a round surface, whose strips no mesh should keep
    TriMesh clean = surface;
    (void)remove_slivers(clean);
    Result<FacetedSurface> faceted = flat_faces(clean, most);
    if (!faceted) return tl::unexpected(faceted.error());
    if (const std::size_t smooth = smooth_faces(*faceted); smooth > most_smooth)
        return input_error("its surface is round: {} of its flat faces go on into another one without an edge", smooth);
    return std::make_shared<const SolidNode>(
        SolidNode{PolyhedronSolid{std::make_shared<const FacetedSurface>(std::move(*faceted)),
                                  std::make_shared<const TriangleTree>(std::move(clean))}});
}

}  // namespace pliant::mesh
