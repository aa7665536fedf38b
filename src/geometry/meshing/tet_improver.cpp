#include "geometry/meshing/tet_improver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "geometry/meshing/editable_tets.hpp"
#include "geometry/meshing/node_freedom.hpp"

namespace pliant::mesh {
namespace {

double sine(double degrees) {
    return std::sin(degrees * std::numbers::pi / 180);
}
double cosine(double degrees) {
    return std::cos(degrees * std::numbers::pi / 180);
}

class Improver {
public:
    Improver(TetMesh& mesh, const ImproveSettings& settings)
        : mesh_(mesh),
          tets_(mesh),
          wanted_(sine(settings.wanted_deg)),
          smooth_(cosine(settings.feature_deg)),
          slid_(mesh.points.size(), 0) {}

    void run() {
        constexpr int rounds = 12;
        // If one tet in this many is bad, walls are thinner than the edges are long, and single additional nodes do not
        // help.
        constexpr std::size_t many = 10;
        for (int round = 0; round < rounds; ++round) {
            bool better = false;
            const std::vector<int> bad = bad_tets();
            const bool may_add_nodes = round >= 2 && many * bad.size() < index(tets_.tet_count());
            for (const int t : bad) {
                if (tets_.alive(t) && tets_.quality(t) < wanted_) better = improve(t, may_add_nodes) || better;
            }
            if (!better) break;
        }
        if (tets_.steps() > 0) tets_.store(mesh_);
    }

private:
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }

    /// Moves a node to where the worst tet around it is best.
    bool move(int v) {
        const Freedom f = freedom_of(tets_, v, smooth_);
        constexpr int most_slides = 3;
        if (f.dimensions == 0 || (f.curved && slid_[index(v)] >= most_slides)) return false;
        const std::vector<Border> surface = f.curved ? tets_.borders(v) : std::vector<Border>{};
        const std::vector<int>& star = tets_.star(v);
        double edges = 0;
        for (const int t : star) {
            for (const int w : tets_.tet(t)) edges += norm(tets_.at(w) - tets_.at(v)) / 3;
        }
        const double old = tets_.worst(star), length = edges / static_cast<double>(star.size());
        const Vec3 home = tets_.at(v);
        Vec3 best = home;
        double best_quality = old;
        for (double step = 0.3 * length; step > 1e-3 * length; step /= 2) {
            for (int again = 0; again < 4; ++again) {
                const Vec3 from = best;
                tets_.place(v, home);
                for (const Vec3& way : ways()) {
                    tets_.place(v, home);
                    const auto place = allowed_place(tets_, v, f, surface, from - home + step * way);
                    if (!place) continue;
                    tets_.place(v, *place);
                    const double its = tets_.worst(star);
                    if (its <= best_quality + least_gain || (f.curved && folds(surface))) continue;
                    best = *place;
                    best_quality = its;
                }
                if (best == from) break;
            }
        }
        tets_.place(v, best);
        if (best == home) return false;
        slid_[index(v)] += f.curved ? 1 : 0;
        tets_.keep_move(v, home);
        return true;
    }

    /// Whether a triangle of the surface has rotated too far.
    [[nodiscard]] bool folds(const std::vector<Border>& before) const {
        return std::any_of(before.begin(), before.end(),
                           [&](const Border& b) { return dot(tets_.normal(b.nodes), b.normal) < smooth_; });
    }

    /// Directions to try: to the faces and corners of a cube.
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

    /// The nodes around edge a-b in order, such that (a, b, n[i], n[i + 1]) are its tets; empty unless they form a
    /// single ring or fan in one region.
    [[nodiscard]] std::vector<int> ring(int a, int b, const std::vector<int>& tets, bool& closed) const {
        std::vector<std::pair<int, int>> links;
        for (const int t : tets) {
            if (tets_.region(t) != tets_.region(tets.front())) return {};
            std::array<int, 2> rest{};
            std::size_t n = 0;
            for (const int v : tets_.tet(t)) {
                if (v != a && v != b) rest[n++] = v;
            }
            const bool turned = signed_tet_volume(tets_.at(a), tets_.at(b), tets_.at(rest[0]), tets_.at(rest[1])) < 0;
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

    /// Removes edge a-b: the ring around it is triangulated, with two tets per triangle, one to each end of the edge,
    /// such that the worst tet is best (Klincsek's dynamic programme, as in Shewchuk, Two Discrete Optimization
    /// Algorithms for the Topological Improvement of Tetrahedral Meshes, 2002).
    bool remove_edge(int a, int b) {
        const std::vector<int> tets = tets_.around(a, b);
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
                    const double its =
                        std::min({best[i][k], best[k][j], tets_.quality({nodes[i], nodes[k], nodes[j], b}),
                                  tets_.quality({nodes[i], nodes[j], nodes[k], a})});
                    if (its > best[i][j]) {
                        best[i][j] = its;
                        middle[i][j] = k;
                    }
                }
            }
        }
        if (best[0][n - 1] <= tets_.worst(tets) + least_gain) return false;
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
        return tets_.apply(change, closed ? same_volume : sliver_volume);
    }

    /// Whether edge c-d may replace a-b in the surface.
    [[nodiscard]] bool may_swap_surface(int a, int b, int c, int d, const std::vector<int>& tets) const {
        for (const Border& one : tets_.borders(c)) {
            if (std::find(one.nodes.begin(), one.nodes.end(), d) != one.nodes.end()) return false;
        }
        std::vector<Vec3> before;
        for (const int t : tets) {
            for (std::size_t f = 0; f < 4; ++f) {
                const int gone = tets_.tet(t)[f];
                if (gone == a || gone == b) continue;
                const int other = tets_.behind(t, f);
                if (other >= 0 && tets_.region(other) == tets_.region(t)) continue;
                if (other >= 0) return false;  // a face between two regions belongs to both
                before.push_back(tets_.normal(tets_.face(t, f)));
            }
        }
        if (before.size() != 2 || dot(before[0], before[1]) < smooth_) return false;
        Vec3 one = tets_.normal({a, c, d}), other = tets_.normal({b, d, c});
        if (dot(one, before[0]) < 0) one = -one, other = -other;
        return dot(one, before[0]) > smooth_ && dot(one, before[1]) > smooth_ && dot(other, before[0]) > smooth_ &&
               dot(other, before[1]) > smooth_;
    }

    /// Replaces two tets at a face by three around the edge between the nodes opposite to it.
    bool remove_face(int t, std::size_t f) {
        const int other = tets_.behind(t, f);
        if (other < 0 || tets_.region(other) != tets_.region(t)) return false;
        const int a = tets_.tet(t)[f];
        const Triangle face = tets_.face(t, f);
        const auto beyond = std::find_if(tets_.tet(other).begin(), tets_.tet(other).end(),
                                         [&](int v) { return std::find(face.begin(), face.end(), v) == face.end(); });
        const int b = *beyond;
        Exchange change{{t, other}, {}};
        for (std::size_t k = 0; k < 3; ++k) change.added.push_back({a, b, face[(k + 1) % 3], face[k]});
        if (tets_.tet_volume(change.added[0]) < 0) {
            for (Tet& n : change.added) std::swap(n[2], n[3]);
        }
        if (tets_.worst(change.added) <= tets_.worst(change.removed) + least_gain) return false;
        return tets_.apply(change, same_volume);
    }

    /// Merges node v into its neighbour w; the tets that contain both vanish.
    bool join(int v, int w) {
        const Freedom f = freedom_of(tets_, v, smooth_);
        if (f.dimensions == 0 || f.curved) return false;
        const Vec3 way = (tets_.at(w) - tets_.at(v)) / norm(tets_.at(w) - tets_.at(v));
        if (f.dimensions == 2 && std::fabs(dot(way, f.axis)) > 1 - one_plane) return false;
        if (f.dimensions == 1 && std::fabs(dot(way, f.axis)) < one_plane) return false;
        Exchange change{tets_.star(v), {}};
        std::vector<int> regions;
        for (const int t : change.removed) {
            if (tets_.holds(t, w)) continue;
            Tet moved = tets_.tet(t);
            std::replace(moved.begin(), moved.end(), v, w);
            change.added.push_back(moved);
            regions.push_back(tets_.region(t));
        }
        if (change.added.empty() || tets_.worst(change.added) <= tets_.worst(change.removed) + least_gain) return false;
        return tets_.apply(change, same_volume, regions);
    }

    /// Inserts a node in the middle of edge a-b.
    int halve(int a, int b) {
        Exchange change{tets_.around(a, b), {}};
        std::vector<int> regions;
        const int v = tets_.add_node(0.5 * (tets_.at(a) + tets_.at(b)));
        slid_.push_back(0);
        for (const int t : change.removed) {
            for (const int end : {a, b}) {
                Tet half = tets_.tet(t);
                std::replace(half.begin(), half.end(), end, v);
                change.added.push_back(half);
                regions.push_back(tets_.region(t));
            }
        }
        tets_.apply(change, sliver_volume, regions);
        return v;
    }

    /// Splits an edge of a tet and improves from there; undone if that does not help.
    bool try_halving(int t) {
        std::array<std::array<int, 2>, 6> edges{};
        for (std::size_t e = 0; e < 6; ++e)
            edges[e] = {tets_.tet(t)[index(edge_corners[e][0])], tets_.tet(t)[index(edge_corners[e][1])]};
        const auto length = [&](const std::array<int, 2>& e) { return norm(tets_.at(e[0]) - tets_.at(e[1])); };
        std::stable_sort(edges.begin(), edges.end(),
                         [&](const auto& l, const auto& r) { return length(l) > length(r); });
        constexpr std::size_t longest = 4;
        for (std::size_t e = 0; e < longest; ++e) {
            const std::size_t mark = tets_.steps(), nodes = tets_.node_count();
            const int first_new = tets_.tet_count();
            const double old = tets_.worst(tets_.around(edges[e][0], edges[e][1]));
            const int v = halve(edges[e][0], edges[e][1]);
            move(v);
            for (int again = 0; again < 3; ++again) {
                const std::vector<int> star = tets_.star(v);
                for (const int near : star) {
                    if (tets_.alive(near) && tets_.quality(near) < wanted_) improve(near, false);
                }
                move(v);
            }
            if (tets_.worst(tets_.touched_since(mark, first_new)) > 1.02 * old + least_gain) return true;
            tets_.undo(mark);
            tets_.drop_nodes(nodes);
            slid_.resize(nodes);
        }
        return false;
    }

    /// Any operation that improves a tet or its replacements.
    bool improve(int t, bool may_add_nodes) {
        const Tet n = tets_.tet(t);
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

    /// The worst first.
    [[nodiscard]] std::vector<int> bad_tets() const {
        std::vector<std::pair<double, int>> bad;
        for (int t = 0; t < tets_.tet_count(); ++t) {
            if (!tets_.alive(t)) continue;
            if (const double its = tets_.quality(t); its < wanted_) bad.emplace_back(its, t);
        }
        std::sort(bad.begin(), bad.end());
        std::vector<int> tets;
        tets.reserve(bad.size());
        for (const auto& [quality, t] : bad) tets.push_back(t);
        return tets;
    }

    static constexpr double least_gain = 1e-6;     ///< in sine
    static constexpr double same_volume = 1e-9;    ///< rounding error, as a fraction of the cubed edge length
    static constexpr double sliver_volume = 0.02;  ///< of a tet on a curved surface, as a fraction of the cubed edge
                                                   ///< length

    TetMesh& mesh_;
    EditableTets tets_;
    double wanted_, smooth_;
    std::vector<int> slid_;  ///< per node, how many times it was moved over a curved surface
};

}  // namespace

void improve_tets(TetMesh& mesh, const ImproveSettings& settings) {
    Improver(mesh, settings).run();
}

}  // namespace pliant::mesh
