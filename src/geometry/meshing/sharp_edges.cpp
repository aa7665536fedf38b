#include "geometry/meshing/sharp_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "base/core/disjoint_sets.hpp"

namespace pliant::mesh {
namespace {

/// Points, in order, and the first surface that contains them.
struct Chain {
    std::vector<int> points;
    int surface;
};

/// Minimum distance of edges that do not meet, as a fraction of the mesh size.
constexpr double least_room = 0.1;

/// Chains shorter than this fraction of the mesh size become points: otherwise the mesh would have to be as fine around
/// them.
constexpr double least_length = 0.1;

/// Gives each point in space one number, whatever surface it belongs to.
class Welder {
public:
    /// Identical points of a drawing differ at most in the last digits of 32-bit floats.
    explicit Welder(double width) : width_(width) {}

    int number(const Vec3& p) {
        std::array<long, 3> cell{};
        for (std::size_t k = 0; k < 3; ++k) cell[k] = std::lround(p[k] / width_);
        const auto [entry, fresh] = numbers_.try_emplace(cell, static_cast<int>(points_.size()));
        if (fresh) points_.push_back(p);
        return entry->second;
    }
    [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }

private:
    double width_;
    std::map<std::array<long, 3>, int> numbers_;
    std::vector<Vec3> points_;
};

class EdgeFinder {
public:
    EdgeFinder(const LabelledSpace& space, double size, double angle_deg)
        : space_(space),
          size_(size),
          least_cosine_(std::cos(angle_deg * std::numbers::pi / 180)),
          welder_(weld_share * whole(space).diagonal() + std::numeric_limits<double>::min()) {}

    /// Chains of sharp edges that bound material, split where three or more meet and at sharp bends.
    std::vector<Chain> find() {
        for (std::size_t s = 0; s < space_.surfaces().size(); ++s) collect(static_cast<int>(s));
        std::vector<Chain> lines;
        for (const auto& [node, ends] : next_) {
            const bool through = ends.size() == 2 && surface_of(node, ends[0]) == surface_of(node, ends[1]);
            if (through) continue;
            for (const int end : ends) walk(node, end, lines);
        }
        for (const auto& [node, ends] : next_) {  // only closed loops are left
            for (const int end : ends) walk(node, end, lines);
        }
        return lines;
    }

    [[nodiscard]] const std::vector<Vec3>& points() const { return welder_.points(); }

private:
    static constexpr double weld_share = 1e-7;  // of the total size

    static Box3 whole(const LabelledSpace& space) {
        Box3 box;
        for (const WindingGrid& surface : space.surfaces()) {
            if (surface.box().empty()) continue;
            box.add(surface.box().low);
            box.add(surface.box().high);
        }
        return box;
    }

    void collect(int surface) {
        std::map<std::pair<int, int>, std::vector<int>> triangles_of;
        const TriMesh& mesh = space_.surfaces()[static_cast<std::size_t>(surface)].surface();
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
                triangles_of[{low, high}].push_back(static_cast<int>(t));
            }
        }
        for (const auto& [edge, triangles] : triangles_of) {
            if (triangles.size() != 2 || dot(normal(mesh, triangles[0]), normal(mesh, triangles[1])) > least_cosine_)
                continue;
            const Vec3& a = mesh.points[static_cast<std::size_t>(edge.first)];
            const Vec3& b = mesh.points[static_cast<std::size_t>(edge.second)];
            if (labels_meet(a, b)) add(welder_.number(a), welder_.number(b), surface);
        }
    }

    void add(int a, int b, int surface) {
        if (a == b || !surface_of_.try_emplace(std::minmax(a, b), surface).second) return;
        next_[a].push_back(b);
        next_[b].push_back(a);
    }

    [[nodiscard]] int surface_of(int a, int b) const { return surface_of_.at(std::minmax(a, b)); }
    [[nodiscard]] static Vec3 normal(const TriMesh& mesh, int triangle) {
        const auto& [a, b, c] = mesh.triangles[static_cast<std::size_t>(triangle)];
        const auto at = [&](int node) { return mesh.points[static_cast<std::size_t>(node)]; };
        return unit(cross(at(b) - at(a), at(c) - at(a)));
    }
    [[nodiscard]] const Vec3& at(int node) const { return points()[static_cast<std::size_t>(node)]; }

    /// Whether there is more than one label near the middle of the edge.
    [[nodiscard]] bool labels_meet(const Vec3& a, const Vec3& b) const {
        const Vec3 along = b - a;
        const Vec3 middle = 0.5 * (a + b);
        const double radius = 0.02 * std::min(size_, norm(along));
        const Vec3 other = std::fabs(along.x) < 0.6 * norm(along) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
        const Vec3 u = unit(cross(along, other));
        const Vec3 v = cross(along, u) / norm(along);
        constexpr int directions = 16;
        int first = 0;
        for (int i = 0; i < directions; ++i) {
            const double turn = 2 * std::numbers::pi * (i + 0.37) / directions;
            const int label = space_.label(middle + radius * (std::cos(turn) * u + std::sin(turn) * v));
            if (i == 0) first = label;
            if (label != first) return true;
        }
        return false;
    }

    /// Follows the chain from `from` over `to` to its end, unless it was already followed from the other end.
    void walk(int from, int to, std::vector<Chain>& lines) {
        if (!done_.insert(std::minmax(from, to)).second) return;
        const int start = from;
        const int surface = surface_of(from, to);
        Chain line{{from, to}, surface};
        while (to != start && next_[to].size() == 2) {
            const int onward = next_[to][0] == from ? next_[to][1] : next_[to][0];
            const Vec3 before = at(to) - at(from);
            const Vec3 after = at(onward) - at(to);
            if (dot(before, after) < least_cosine_ * norm(before) * norm(after)) break;  // a corner
            if (surface_of(to, onward) != surface) break;
            if (!done_.insert(std::minmax(to, onward)).second) break;
            from = to;
            to = onward;
            line.points.push_back(to);
        }
        lines.push_back(std::move(line));
    }

    const LabelledSpace& space_;
    double size_;
    double least_cosine_;
    Welder welder_;
    std::map<int, std::vector<int>> next_;
    std::map<std::pair<int, int>, int> surface_of_;  ///< of each edge, the first that contains it
    std::set<std::pair<int, int>> done_;
};

/// Merges the ends of chains that are connected by short chains.
class Contraction {
public:
    Contraction(const std::vector<Vec3>& points, double width)
        : points_(points), width_(width), sets_(points.size()), boxes_(points.size()) {
        for (std::size_t i = 0; i < points.size(); ++i) boxes_[i].add(points[i]);
    }

    /// Shortest first; ends are merged only while all of them fit into the width.
    std::vector<Chain> contract(std::vector<Chain> chains) {
        std::vector<std::pair<double, std::size_t>> order;
        for (std::size_t c = 0; c < chains.size(); ++c) {
            const double its = length(chains[c]);
            if (its < width_) order.emplace_back(its, c);
        }
        std::sort(order.begin(), order.end());
        for (const auto& [its, c] : order) join(chains[c].points.front(), chains[c].points.back());
        for (Chain& chain : chains) move_ends(chain);
        std::set<std::pair<int, int>> seen;  // edges that have become identical
        std::erase_if(chains, [&](const Chain& c) {
            if (length(c) < width_) return true;
            return c.points.size() == 2 && !seen.insert(std::minmax(c.points[0], c.points[1])).second;
        });
        return chains;
    }

private:
    [[nodiscard]] const Vec3& at(int node) const { return points_[static_cast<std::size_t>(node)]; }
    [[nodiscard]] double length(const Chain& chain) const {
        double sum = 0;
        for (std::size_t i = 0; i + 1 < chain.points.size(); ++i)
            sum += norm(at(chain.points[i + 1]) - at(chain.points[i]));
        return sum;
    }
    Box3& box(int node) { return boxes_[static_cast<std::size_t>(sets_.find(node))]; }

    void join(int a, int b) {
        Box3 both = box(a);
        both.add(box(b).low);
        both.add(box(b).high);
        if (both.diagonal() > 1.5 * width_) return;
        sets_.join(a, b);
        box(a) = both;
    }

    /// Removes points within the distance by which the ends may have moved: they would make the chain go back and
    /// forth.
    void move_ends(Chain& chain) {
        std::vector<int> moved = {sets_.find(chain.points.front())};
        const int last = sets_.find(chain.points.back());
        const bool stays = moved.front() == chain.points.front() && last == chain.points.back();
        for (std::size_t i = 1; i + 1 < chain.points.size(); ++i) {
            const Vec3& p = at(chain.points[i]);
            const bool is_near = norm(p - at(moved.front())) < width_ || norm(p - at(last)) < width_;
            if (stays || !is_near) moved.push_back(chain.points[i]);
        }
        moved.push_back(last);
        chain.points = std::move(moved);
    }

    const std::vector<Vec3>& points_;
    double width_;
    DisjointSets sets_;
    std::vector<Box3> boxes_;  ///< (points) bounds of the merged set of each
};

/// Distance between two segments (Ericson, Real-Time Collision Detection, 5.1.9).
double distance_between(const Vec3& p1, const Vec3& q1, const Vec3& p2, const Vec3& q2) {
    const Vec3 d1 = q1 - p1;
    const Vec3 d2 = q2 - p2;
    const Vec3 r = p1 - p2;
    const double a = dot(d1, d1);
    const double e = dot(d2, d2);
    const double b = dot(d1, d2);
    const double c = dot(d1, r);
    const double f = dot(d2, r);
    const double denominator = a * e - b * b;
    double s = denominator > 1e-12 * a * e ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
    double t = (b * s + f) / e;
    if (t < 0 || t > 1) {
        t = std::clamp(t, 0.0, 1.0);
        s = std::clamp((b * t - c) / a, 0.0, 1.0);
    }
    return norm(p1 + s * d1 - p2 - t * d2);
}

struct Segment {
    int chain, index;  ///< from point `index` of the chain to the next
    Vec3 from, to;
    double start, end;  ///< arc length along the chain
    double low, high;   ///< in x, with margin
    bool dropped = false;
};

/// For edges that meet: the angle in radians, and the distance as a fraction of the path from one to the other through
/// their common point.
constexpr double small_angle = 0.25;

class CollisionFinder {
public:
    CollisionFinder(const std::vector<Vec3>& points, const std::vector<Chain>& chains, double room)
        : chains_(chains), room_(room) {
        for (std::size_t c = 0; c < chains.size(); ++c) {
            double along = 0;
            const std::vector<int>& chain = chains[c].points;
            for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
                const Vec3& a = points[static_cast<std::size_t>(chain[i])];
                const Vec3& b = points[static_cast<std::size_t>(chain[i + 1])];
                const double end = along + norm(b - a);
                segments_.push_back({static_cast<int>(c), static_cast<int>(i), a, b, along, end,
                                     std::min(a.x, b.x) - room, std::max(a.x, b.x) + room});
                along = end;
            }
            length_.push_back(along);
        }
    }

    /// Marks every segment that is too near to one that it does not meet.
    const std::vector<Segment>& find() {
        std::vector<std::size_t> order(segments_.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::sort(order.begin(), order.end(),
                  [&](std::size_t a, std::size_t b) { return segments_[a].low < segments_[b].low; });
        std::vector<std::size_t> open;
        for (const std::size_t i : order) {
            std::erase_if(open, [&](std::size_t o) { return segments_[o].high < segments_[i].low; });
            for (const std::size_t o : open) {
                if (!collide(segments_[i], segments_[o])) continue;
                const int mine = surface(segments_[i]), its = surface(segments_[o]);
                segments_[i].dropped = segments_[i].dropped || mine >= its;
                segments_[o].dropped = segments_[o].dropped || its >= mine;
            }
            open.push_back(i);
        }
        return segments_;
    }

private:
    [[nodiscard]] int surface(const Segment& s) const { return chains_[static_cast<std::size_t>(s.chain)].surface; }
    [[nodiscard]] bool collide(const Segment& a, const Segment& b) const {
        for (std::size_t k = 1; k < 3; ++k) {
            if (std::min(a.from[k], a.to[k]) > std::max(b.from[k], b.to[k]) + room_ ||
                std::min(b.from[k], b.to[k]) > std::max(a.from[k], a.to[k]) + room_)
                return false;
        }
        const double path = path_between(a, b);
        if (path == 0) return part_at_small_angle(a, b);
        return distance_between(a.from, a.to, b.from, b.to) < (path > 3 * room_ ? room_ : small_angle * path);
    }

    /// For segments with a common end.
    [[nodiscard]] static bool part_at_small_angle(const Segment& a, const Segment& b) {
        const Vec3& common = a.from == b.from || a.from == b.to ? a.from : a.to;
        const Vec3 one = a.from + a.to - 2 * common;
        const Vec3 other = b.from + b.to - 2 * common;
        return dot(one, other) > 0 && norm(cross(one, other)) < small_angle * norm(one) * norm(other);
    }

    /// Distance along the chains from one to the other, through at most one common end.
    [[nodiscard]] double path_between(const Segment& a, const Segment& b) const {
        const std::vector<int>& one = chains_[static_cast<std::size_t>(a.chain)].points;
        const std::vector<int>& other = chains_[static_cast<std::size_t>(b.chain)].points;
        const double length_a = length_[static_cast<std::size_t>(a.chain)];
        const double length_b = length_[static_cast<std::size_t>(b.chain)];
        double least = std::numeric_limits<double>::infinity();
        if (a.chain == b.chain) least = std::max(b.start - a.end, a.start - b.end);
        const auto by_end = [&](int p, int q, double from_a, double from_b) {
            if (p == q) least = std::min(least, from_a + from_b);
        };
        by_end(one.front(), other.front(), a.start, b.start);
        by_end(one.front(), other.back(), a.start, length_b - b.end);
        by_end(one.back(), other.front(), length_a - a.end, b.start);
        by_end(one.back(), other.back(), length_a - a.end, length_b - b.end);
        return least;
    }

    const std::vector<Chain>& chains_;
    double room_;
    std::vector<Segment> segments_;  ///< chain by chain, in order
    std::vector<double> length_;
};

}  // namespace

SharpEdges sharp_edges(const LabelledSpace& space, double size, double angle_deg) {
    EdgeFinder edge_finder(space, size, angle_deg);
    std::vector<Chain> found = edge_finder.find();
    const std::vector<Chain> chains = Contraction(edge_finder.points(), least_length * size).contract(std::move(found));
    SharpEdges edges;
    std::vector<Vec3> chain;
    const auto end_chain = [&] {
        if (chain.size() > 1) edges.chains.push_back(chain);
        chain.clear();
    };
    CollisionFinder finder(edge_finder.points(), chains, least_room * size);
    for (const Segment& segment : finder.find()) {
        if (segment.index == 0 || segment.dropped) end_chain();
        edges.dropped += segment.dropped ? 1 : 0;
        if (segment.dropped) continue;
        if (chain.empty()) chain.push_back(segment.from);
        chain.push_back(segment.to);
    }
    end_chain();
    return edges;
}

}  // namespace pliant::mesh
