#include "geometry/meshing/tet_improver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace pliant::mesh {
namespace {

using Tet = std::array<int, 4>;
using Triangle = std::array<int, 3>;

double sine(double degrees) {
    return std::sin(degrees * std::numbers::pi / 180);
}
double cosine(double degrees) {
    return std::cos(degrees * std::numbers::pi / 180);
}

/// The corners between which the edge of faces i and j (opposite to corners i and j) runs.
std::pair<std::size_t, std::size_t> common_edge(std::size_t i, std::size_t j) {
    std::size_t k = 0;
    while (k == i || k == j) ++k;
    return {k, 6 - i - j - k};
}

/// The smallest sine of a dihedral angle; not above zero for a flat or folded tet. sin = 3 V l / (2 A B), with l the
/// edge between faces of areas A and B.
double quality_of(const std::array<Vec3, 4>& p) {
    const double volume6 = 6 * signed_tet_volume(p[0], p[1], p[2], p[3]);
    std::array<double, 4> area2{};
    for (std::size_t f = 0; f < 4; ++f) {
        const auto at = [&](std::size_t k) { return p[static_cast<std::size_t>(face_corners[f][k])]; };
        area2[f] = norm(cross(at(1) - at(0), at(2) - at(0)));
        if (!(area2[f] > 0)) return 0;
    }
    double least = 1;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const auto [a, b] = common_edge(i, j);
            least = std::min(least, volume6 * norm(p[a] - p[b]) / (area2[i] * area2[j]));
        }
    }
    return least;
}

/// A face between a region and another, or the outside.
struct Border {
    Triangle nodes;
    Vec3 normal;  ///< of length 1
};

/// Where a node may go.
struct Freedom {
    int dimensions = 0;
    Vec3 axis{};          ///< for 2 dimensions: normal to them; for 1: along it
    bool curved = false;  ///< over the borders around, not in a plane
};

/// Tets that take the place of others.
struct Exchange {
    std::vector<int> removed;
    std::vector<Tet> added;
};

class Improver {
public:
    Improver(TetMesh& mesh, const ImproveSettings& settings)
        : mesh_(mesh),
          points_(mesh.points),
          wanted_(sine(settings.wanted_deg)),
          smooth_(cosine(settings.feature_deg)),
          region_(mesh.region),
          slid_(mesh.points.size(), 0),
          star_(mesh.points.size()) {
        for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
            const auto n = mesh.tet(t);
            tets_.push_back({n[0], n[1], n[2], n[3]});
            for (const int v : tets_.back()) star_[index(v)].push_back(static_cast<int>(t));
        }
    }

    void run() {
        constexpr int rounds = 12;
        // Where so many are bad, walls are thinner than edges are long, and more nodes here and there do not help.
        constexpr std::size_t many = 10;
        for (int round = 0; round < rounds; ++round) {
            bool better = false;
            const std::vector<int> bad = bad_tets();
            const bool may_add_nodes = round >= 2 && many * bad.size() < tets_.size();
            for (const int t : bad) {
                if (alive(t) && quality(t) < wanted_) better = improve(t, may_add_nodes) || better;
            }
            if (!better) break;
        }
        if (!log_.empty()) store();
    }

private:
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }
    [[nodiscard]] const Tet& tet(int t) const { return tets_[index(t)]; }
    [[nodiscard]] bool alive(int t) const { return region_[index(t)] >= 0; }
    [[nodiscard]] const Vec3& at(int v) const { return points_[index(v)]; }
    [[nodiscard]] bool holds(int t, int v) const { return std::find(tet(t).begin(), tet(t).end(), v) != tet(t).end(); }
    [[nodiscard]] double quality(const Tet& n) const { return quality_of({at(n[0]), at(n[1]), at(n[2]), at(n[3])}); }
    [[nodiscard]] double quality(int t) const { return quality(tet(t)); }
    template <class Tets>
    [[nodiscard]] double worst(const Tets& tets) const {
        double least = 1;
        for (const auto& t : tets) least = std::min(least, quality(t));
        return least;
    }
    [[nodiscard]] double tet_volume(const Tet& n) const {
        return signed_tet_volume(at(n[0]), at(n[1]), at(n[2]), at(n[3]));
    }

    /// The tets that hold both nodes.
    [[nodiscard]] std::vector<int> around(int a, int b) const {
        std::vector<int> found;
        for (const int t : star_[index(a)]) {
            if (holds(t, b)) found.push_back(t);
        }
        return found;
    }

    /// The tet behind face f of t; -1: none.
    [[nodiscard]] int behind(int t, std::size_t f) const {
        const auto node = [&](std::size_t k) { return tet(t)[index(face_corners[f][k])]; };
        for (const int other : star_[index(node(0))]) {
            if (other != t && holds(other, node(1)) && holds(other, node(2))) return other;
        }
        return -1;
    }

    [[nodiscard]] std::optional<Border> border(int t, std::size_t f) const {
        const int other = behind(t, f);
        // Of the two sides of a face between regions, the one with the lower number tells.
        if (other >= 0 && region_[index(other)] <= region_[index(t)]) return std::nullopt;
        Triangle nodes{};
        for (std::size_t k = 0; k < 3; ++k) nodes[k] = tet(t)[index(face_corners[f][k])];
        return Border{nodes, normal(nodes)};
    }

    [[nodiscard]] Vec3 normal(const Triangle& n) const {
        const Vec3 area = cross(at(n[1]) - at(n[0]), at(n[2]) - at(n[0]));
        const double length = norm(area);
        return length > 0 ? area / length : Vec3{};
    }

    [[nodiscard]] std::vector<Border> borders(int v) const {
        std::vector<Border> found;
        for (const int t : star_[index(v)]) {
            for (std::size_t f = 0; f < 4; ++f) {
                if (tet(t)[f] == v) continue;
                if (const auto one = border(t, f)) found.push_back(*one);
            }
        }
        return found;
    }

    [[nodiscard]] Freedom freedom(int v) const {
        const std::vector<Border> all = borders(v);
        if (all.empty()) return {3, {}, false};
        Vec3 sum;
        for (const Border& b : all) sum += b.normal;
        const bool flat = std::all_of(all.begin(), all.end(),
                                      [&](const Border& b) { return dot(b.normal, all.front().normal) > level; });
        if (flat) return {2, all.front().normal, false};
        const std::vector<Vec3> ridges = ridges_at(v, all);
        if (ridges.empty() && norm(sum) > 0) return {2, unit(sum), true};
        if (ridges.size() == 2 && dot(ridges[0], ridges[1]) < -level) return {1, ridges[0], false};
        return {};
    }

    /// Directions of the sharp edges that leave a node.
    [[nodiscard]] std::vector<Vec3> ridges_at(int v, const std::vector<Border>& all) const {
        std::vector<Vec3> ridges;
        std::vector<int> seen;
        for (const Border& b : all) {
            for (const int w : b.nodes) {
                if (w == v || std::find(seen.begin(), seen.end(), w) != seen.end()) continue;
                seen.push_back(w);
                std::vector<const Border*> sides;
                for (const Border& other : all) {
                    if (std::find(other.nodes.begin(), other.nodes.end(), w) != other.nodes.end())
                        sides.push_back(&other);
                }
                if (sides.size() == 2 && dot(sides[0]->normal, sides[1]->normal) > smooth_) continue;
                ridges.push_back((at(w) - at(v)) / norm(at(w) - at(v)));
            }
        }
        return ridges;
    }

    /// The allowed place nearest to a wish; nothing where a curved surface has none there.
    [[nodiscard]] std::optional<Vec3> allowed(int v, const Freedom& f, const std::vector<Border>& surface,
                                              const Vec3& step) const {
        if (f.dimensions == 3) return at(v) + step;
        if (f.dimensions == 1) return at(v) + dot(step, f.axis) * f.axis;
        const Vec3 level_step = step - dot(step, f.axis) * f.axis;
        if (!f.curved) return at(v) + level_step;
        for (const Border& b : surface) {
            const double along = dot(b.normal, f.axis);
            if (!(along > 0.1)) continue;
            // Onto the plane of the triangle, along the axis.
            const Vec3 p = at(v) + level_step - (dot(level_step, b.normal) / along) * f.axis;
            if (inside(p, b)) return p;
        }
        return std::nullopt;
    }

    [[nodiscard]] bool inside(const Vec3& p, const Border& b) const {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &from = at(b.nodes[k]), &to = at(b.nodes[(k + 1) % 3]);
            if (dot(cross(to - from, p - from), b.normal) < -1e-12 * dot(to - from, to - from)) return false;
        }
        return true;
    }

    /// Moves a node to where the worst tet around it is best.
    bool move(int v) {
        const Freedom f = freedom(v);
        constexpr int most_slides = 3;
        if (f.dimensions == 0 || (f.curved && slid_[index(v)] >= most_slides)) return false;
        const std::vector<Border> surface = f.curved ? borders(v) : std::vector<Border>{};
        const std::vector<int>& star = star_[index(v)];
        double edges = 0;
        for (const int t : star) {
            for (const int w : tet(t)) edges += norm(at(w) - at(v)) / 3;
        }
        const double old = worst(star), length = edges / static_cast<double>(star.size());
        const Vec3 home = at(v);
        Vec3 best = home;
        double best_quality = old;
        for (double step = 0.3 * length; step > 1e-3 * length; step /= 2) {
            for (int again = 0; again < 4; ++again) {
                const Vec3 from = best;
                points_[index(v)] = home;
                for (const Vec3& way : ways()) {
                    points_[index(v)] = home;
                    const auto place = allowed(v, f, surface, from - home + step * way);
                    if (!place) continue;
                    points_[index(v)] = *place;
                    const double its = worst(star);
                    if (its <= best_quality + least_gain || (f.curved && folds(surface))) continue;
                    best = *place;
                    best_quality = its;
                }
                if (best == from) break;
            }
        }
        points_[index(v)] = best;
        if (best == home) return false;
        slid_[index(v)] += f.curved ? 1 : 0;
        log_.push_back({{}, 0, v, home});
        return true;
    }

    /// Whether a triangle of the surface has turned too far.
    [[nodiscard]] bool folds(const std::vector<Border>& before) const {
        return std::any_of(before.begin(), before.end(),
                           [&](const Border& b) { return dot(normal(b.nodes), b.normal) < smooth_; });
    }

    /// Directions to try: to the sides and corners of a cube.
    static const std::vector<Vec3>& ways() {
        static const std::vector<Vec3> all = [] {
            std::vector<Vec3> made;
            for (int i = -1; i <= 1; ++i) {
                for (int j = -1; j <= 1; ++j) {
                    for (int k = -1; k <= 1; ++k) {
                        const Vec3 way{double(i), double(j), double(k)};
                        if (norm(way) > 0) made.push_back(unit(way));
                    }
                }
            }
            return made;
        }();
        return all;
    }

    /// The nodes around edge a-b in order, such that (a, b, n[i], n[i + 1]) are its tets; empty where they make no
    /// single ring or fan of one region.
    [[nodiscard]] std::vector<int> ring(int a, int b, const std::vector<int>& tets, bool& closed) const {
        std::vector<std::pair<int, int>> links;
        for (const int t : tets) {
            if (region_[index(t)] != region_[index(tets.front())]) return {};
            std::array<int, 2> rest{};
            std::size_t n = 0;
            for (const int v : tet(t)) {
                if (v != a && v != b) rest[n++] = v;
            }
            const bool turned = signed_tet_volume(at(a), at(b), at(rest[0]), at(rest[1])) < 0;
            links.emplace_back(rest[turned ? 1 : 0], rest[turned ? 0 : 1]);
        }
        const auto from = [&](int v) {
            return std::find_if(links.begin(), links.end(), [&](const auto& l) { return l.first == v; });
        };
        int start = links.front().first;
        closed = true;
        for (const auto& [first, second] : links) {
            if (std::none_of(links.begin(), links.end(), [v = first](const auto& l) { return l.second == v; })) {
                start = first;
                closed = false;
            }
        }
        std::vector<int> nodes{start};
        for (auto next = from(start); next != links.end() && nodes.size() <= links.size(); next = from(nodes.back())) {
            if (next->second == start) break;
            nodes.push_back(next->second);
        }
        return nodes.size() == links.size() + (closed ? 0 : 1) ? nodes : std::vector<int>{};
    }

    /// Takes edge a-b away: the ring around it is cut into triangles, each with a tet to either end, such that the
    /// worst is best (Klincsek's dynamic programme, as in Shewchuk, Two Discrete Optimization Algorithms for the
    /// Topological Improvement of Tetrahedral Meshes, 2002).
    bool remove_edge(int a, int b) {
        const std::vector<int> tets = around(a, b);
        constexpr std::size_t most = 9;
        bool closed = false;
        if (tets.empty() || tets.size() > most) return false;
        const std::vector<int> nodes = ring(a, b, tets, closed);
        const std::size_t n = nodes.size();
        if (n < 2 || (closed && n < 3) || (!closed && !may_swap_surface(a, b, nodes.front(), nodes.back(), tets)))
            return false;
        std::vector<std::vector<double>> best(n, std::vector<double>(n, 1));
        std::vector<std::vector<std::size_t>> middle(n, std::vector<std::size_t>(n, 0));
        for (std::size_t width = 2; width < n; ++width) {
            for (std::size_t i = 0; i + width < n; ++i) {
                const std::size_t j = i + width;
                best[i][j] = -1;
                for (std::size_t k = i + 1; k < j; ++k) {
                    const double its = std::min({best[i][k], best[k][j], quality({nodes[i], nodes[k], nodes[j], b}),
                                                 quality({nodes[i], nodes[j], nodes[k], a})});
                    if (its > best[i][j]) {
                        best[i][j] = its;
                        middle[i][j] = k;
                    }
                }
            }
        }
        if (best[0][n - 1] <= worst(tets) + least_gain) return false;
        Exchange change{tets, {}};
        std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
        while (!open.empty()) {
            const auto [i, j] = open.back();
            open.pop_back();
            if (j - i < 2) continue;
            const std::size_t k = middle[i][j];
            change.added.push_back({nodes[i], nodes[k], nodes[j], b});
            change.added.push_back({nodes[i], nodes[j], nodes[k], a});
            open.emplace_back(i, k);
            open.emplace_back(k, j);
        }
        return apply(change, closed ? same_volume : sliver_volume);
    }

    /// Whether the surface may have edge c-d instead of a-b.
    [[nodiscard]] bool may_swap_surface(int a, int b, int c, int d, const std::vector<int>& tets) const {
        for (const Border& one : borders(c)) {
            if (std::find(one.nodes.begin(), one.nodes.end(), d) != one.nodes.end()) return false;
        }
        std::vector<Vec3> before;
        for (const int t : tets) {
            for (std::size_t f = 0; f < 4; ++f) {
                const int gone = tet(t)[f];
                if (gone == a || gone == b) continue;
                const int other = behind(t, f);
                if (other >= 0 && region_[index(other)] == region_[index(t)]) continue;
                if (other >= 0) return false;  // a face between two regions is theirs together
                Triangle nodes{};
                for (std::size_t k = 0; k < 3; ++k) nodes[k] = tet(t)[index(face_corners[f][k])];
                before.push_back(normal(nodes));
            }
        }
        if (before.size() != 2 || dot(before[0], before[1]) < smooth_) return false;
        Vec3 one = normal({a, c, d}), other = normal({b, d, c});
        if (dot(one, before[0]) < 0) one = -one, other = -other;
        return dot(one, before[0]) > smooth_ && dot(one, before[1]) > smooth_ && dot(other, before[0]) > smooth_ &&
               dot(other, before[1]) > smooth_;
    }

    /// Two tets at a face become three around the edge between the nodes opposite to it.
    bool remove_face(int t, std::size_t f) {
        const int other = behind(t, f);
        if (other < 0 || region_[index(other)] != region_[index(t)]) return false;
        const int a = tet(t)[f];
        Triangle face{};
        for (std::size_t k = 0; k < 3; ++k) face[k] = tet(t)[index(face_corners[f][k])];
        const auto beyond = std::find_if(tet(other).begin(), tet(other).end(),
                                         [&](int v) { return std::find(face.begin(), face.end(), v) == face.end(); });
        const int b = *beyond;
        Exchange change{{t, other}, {}};
        for (std::size_t k = 0; k < 3; ++k) change.added.push_back({a, b, face[(k + 1) % 3], face[k]});
        if (tet_volume(change.added[0]) < 0) {
            for (Tet& n : change.added) std::swap(n[2], n[3]);
        }
        if (worst(change.added) <= worst(change.removed) + least_gain) return false;
        return apply(change, same_volume);
    }

    /// Moves node v to its neighbour w; the tets that hold both vanish.
    bool join(int v, int w) {
        const Freedom f = freedom(v);
        if (f.dimensions == 0 || f.curved) return false;
        const Vec3 way = (at(w) - at(v)) / norm(at(w) - at(v));
        if (f.dimensions == 2 && std::fabs(dot(way, f.axis)) > 1 - level) return false;
        if (f.dimensions == 1 && std::fabs(dot(way, f.axis)) < level) return false;
        Exchange change{star_[index(v)], {}};
        std::vector<int> regions;
        for (const int t : change.removed) {
            if (holds(t, w)) continue;
            Tet moved = tet(t);
            std::replace(moved.begin(), moved.end(), v, w);
            change.added.push_back(moved);
            regions.push_back(region_[index(t)]);
        }
        if (change.added.empty() || worst(change.added) <= worst(change.removed) + least_gain) return false;
        return apply(change, same_volume, regions);
    }

    /// Puts a node into the middle of edge a-b.
    int halve(int a, int b) {
        Exchange change{around(a, b), {}};
        std::vector<int> regions;
        const int v = static_cast<int>(points_.size());
        points_.push_back(0.5 * (at(a) + at(b)));
        star_.emplace_back();
        slid_.push_back(0);
        for (const int t : change.removed) {
            for (const int end : {a, b}) {
                Tet half = tet(t);
                std::replace(half.begin(), half.end(), end, v);
                change.added.push_back(half);
                regions.push_back(region_[index(t)]);
            }
        }
        apply(change, sliver_volume, regions);
        return v;
    }

    /// Puts a node into an edge of a tet and goes on from there; undone where that does not help.
    bool try_halving(int t) {
        std::array<std::array<int, 2>, 6> edges{};
        for (std::size_t e = 0; e < 6; ++e)
            edges[e] = {tet(t)[index(edge_corners[e][0])], tet(t)[index(edge_corners[e][1])]};
        const auto length = [&](const std::array<int, 2>& e) { return norm(at(e[0]) - at(e[1])); };
        std::stable_sort(edges.begin(), edges.end(),
                         [&](const auto& l, const auto& r) { return length(l) > length(r); });
        constexpr std::size_t longest = 4;
        for (std::size_t e = 0; e < longest; ++e) {
            const std::size_t mark = log_.size(), points = points_.size();
            const int first_new = static_cast<int>(tets_.size());
            const double old = worst(around(edges[e][0], edges[e][1]));
            const int v = halve(edges[e][0], edges[e][1]);
            move(v);
            for (int again = 0; again < 3; ++again) {
                const std::vector<int> star = star_[index(v)];
                for (const int near : star) {
                    if (alive(near) && quality(near) < wanted_) improve(near, false);
                }
                move(v);
            }
            if (worst(touched_since(mark, first_new)) > 1.02 * old + least_gain) return true;
            undo(mark);
            points_.resize(points);
            star_.resize(points);
            slid_.resize(points);
        }
        return false;
    }

    [[nodiscard]] std::vector<int> touched_since(std::size_t mark, int first_new) const {
        std::vector<int> touched;
        for (int t = first_new; t < static_cast<int>(tets_.size()); ++t) {
            if (alive(t)) touched.push_back(t);
        }
        for (std::size_t i = mark; i < log_.size(); ++i) {
            if (log_[i].moved < 0) continue;
            const std::vector<int>& star = star_[index(log_[i].moved)];
            touched.insert(touched.end(), star.begin(), star.end());
        }
        return touched;
    }

    /// Any step that makes a tet, or what takes its place, better.
    bool improve(int t, bool may_add_nodes) {
        const Tet n = tet(t);
        for (const auto& [i, j] : edge_corners) {
            if (remove_edge(n[index(i)], n[index(j)])) return true;
        }
        for (std::size_t f = 0; f < 4; ++f) {
            if (remove_face(t, f)) return true;
        }
        bool moved = false;
        for (const int v : n) moved = move(v) || moved;
        if (moved) return true;
        for (const int v : n) {
            for (const int w : n) {
                if (v != w && join(v, w)) return true;
            }
        }
        return may_add_nodes && try_halving(t);
    }

    /// From the worst on.
    [[nodiscard]] std::vector<int> bad_tets() const {
        std::vector<std::pair<double, int>> bad;
        for (int t = 0; t < static_cast<int>(tets_.size()); ++t) {
            if (!alive(t)) continue;
            if (const double its = quality(t); its < wanted_) bad.emplace_back(its, t);
        }
        std::sort(bad.begin(), bad.end());
        std::vector<int> tets;
        tets.reserve(bad.size());
        for (const auto& [quality, t] : bad) tets.push_back(t);
        return tets;
    }

    /// False, and nothing done, where the volume would change by more than the tolerance times an edge cubed.
    bool apply(const Exchange& change, double tolerance, const std::vector<int>& regions = {}) {
        double volume = 0, size = 0;
        for (const int t : change.removed) {
            volume += tet_volume(tet(t));
            size = std::max(size, norm(at(tet(t)[0]) - at(tet(t)[1])));
        }
        for (const Tet& n : change.added) volume -= tet_volume(n);
        if (std::fabs(volume) > tolerance * size * size * size) return false;
        const int region = region_[index(change.removed.front())];
        Step step{{}, change.added.size(), -1, {}};
        for (const int t : change.removed) {
            for (const int v : tet(t)) std::erase(star_[index(v)], t);
            step.removed.emplace_back(t, std::exchange(region_[index(t)], -1));
        }
        for (std::size_t i = 0; i < change.added.size(); ++i) {
            const int t = static_cast<int>(tets_.size());
            tets_.push_back(change.added[i]);
            region_.push_back(regions.empty() ? region : regions[i]);
            for (const int v : tets_.back()) star_[index(v)].push_back(t);
        }
        log_.push_back(std::move(step));
        return true;
    }

    void undo(std::size_t mark) {
        for (; log_.size() > mark; log_.pop_back()) {
            const Step& step = log_.back();
            if (step.moved >= 0) {
                points_[index(step.moved)] = step.from;
                continue;
            }
            for (std::size_t i = 0; i < step.added; ++i) {
                const int t = static_cast<int>(tets_.size()) - 1;
                for (const int v : tets_.back()) std::erase(star_[index(v)], t);
                tets_.pop_back();
                region_.pop_back();
            }
            for (const auto& [t, region] : step.removed) {
                region_[index(t)] = region;
                for (const int v : tet(t)) star_[index(v)].push_back(t);
            }
        }
    }

    /// Back into the mesh, without what is gone.
    void store() {
        std::vector<int> number(points_.size(), -1);
        std::vector<Vec3> points;
        for (std::size_t v = 0; v < points_.size(); ++v) {
            if (star_[v].empty()) continue;
            number[v] = static_cast<int>(points.size());
            points.push_back(points_[v]);
        }
        mesh_.nodes.clear();
        mesh_.region.clear();
        for (int t = 0; t < static_cast<int>(tets_.size()); ++t) {
            if (!alive(t)) continue;
            for (const int v : tet(t)) mesh_.nodes.push_back(number[index(v)]);
            mesh_.region.push_back(region_[index(t)]);
        }
        mesh_.points = std::move(points);
    }

    /// One change, so that it can be undone: tets for others, or a node moved.
    struct Step {
        std::vector<std::pair<int, int>> removed;  ///< tets and their regions
        std::size_t added = 0;                     ///< the last tets
        int moved = -1;
        Vec3 from{};
    };

    static constexpr double level = 0.99999;       ///< cosine of a quarter of a degree: faces are one plane
    static constexpr double least_gain = 1e-6;     ///< in sine
    static constexpr double same_volume = 1e-9;    ///< what rounding does, of an edge cubed
    static constexpr double sliver_volume = 0.02;  ///< of a tet on a curved surface, of an edge cubed

    TetMesh& mesh_;
    std::vector<Vec3> points_;
    double wanted_, smooth_;
    std::vector<Tet> tets_;
    std::vector<int> region_;             ///< per tet; -1: gone
    std::vector<int> slid_;               ///< per node, how often it was moved over a curved surface
    std::vector<std::vector<int>> star_;  ///< per node, its tets
    std::vector<Step> log_;
};

}  // namespace

void improve_tets(TetMesh& mesh, const ImproveSettings& settings) {
    Improver(mesh, settings).run();
}

}  // namespace pliant::mesh
