#include "base/linalg/dissection.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "base/core/parallel.hpp"
#include "base/linalg/minimum_degree.hpp"
#include "base/linalg/separator.hpp"

namespace pliant::linalg {
namespace {

using Point = Eigen::Vector3f;

constexpr int leaf_nodes = 64;               // pieces of at most this many nodes are not cut further
constexpr int worth_sharing = 4096;          // smallest piece whose two parts go to two cores
constexpr double least_side = 0.1;           // smallest part, as a fraction of the nodes
constexpr std::size_t nodes_at_once = 4096;  // nodes per parallel piece
constexpr int buckets = 256;
constexpr std::size_t planes = 6;            // number of directions in which a piece is cut
constexpr std::size_t level_field = planes;  // index of the last field: distances along edges
constexpr std::size_t fields = 8;            // these seven and a 0, to fill a SIMD register

/// Some of the nodes, ascending, and their subgraph.
struct Piece {
    std::vector<int> node;
    Graph graph;
    std::vector<Point> point;

    [[nodiscard]] int size() const { return static_cast<int>(node.size()); }
};

/// Heights of a node above several planes, and its level, as bucket numbers; compared in one instruction.
using Heights [[gnu::vector_size(fields)]] = std::uint8_t;

/// Nodes up to this height are on the left; the separator is taken from one side.
struct Cut {
    double cost = std::numeric_limits<double>::infinity();
    std::size_t field = 0;
    int height = 0;
    Side from = Side::left;
};

/// Distances from a node, along edges; the farthest node comes last in `order`.
std::vector<int> distances(const Graph& graph, int from, std::vector<int>& order) {
    std::vector<int> distance(static_cast<std::size_t>(graph.nodes()), -1);
    distance[from] = 0;
    order.assign(1, from);
    for (std::size_t k = 0; k < order.size(); ++k) {
        for (int e = graph.start[order[k]]; e < graph.start[order[k] + 1]; ++e) {
            if (const int other = graph.other[e]; distance[other] < 0) {
                distance[other] = distance[order[k]] + 1;
                order.push_back(other);
            }
        }
    }
    return distance;
}

/// Distances of each node from three nodes that are far apart; -1 if not connected.
std::vector<Point> points_by_distance(const Graph& graph) {
    std::vector<Point> points(static_cast<std::size_t>(graph.nodes()));
    std::vector<int> order;
    std::ignore = distances(graph, 0, order);
    std::vector<int> nearest(points.size(), std::numeric_limits<int>::max());
    int from = order.back();
    for (int axis = 0; axis < 3; ++axis) {
        const std::vector<int> distance = distances(graph, from, order);
        for (std::size_t i = 0; i < points.size(); ++i) {
            points[i][axis] = static_cast<float>(distance[i]);
            nearest[i] = std::min(nearest[i], distance[i]);
        }
        from = static_cast<int>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    }
    return points;
}

/// Translated and scaled to within 1 of the first point.
std::vector<Point> scaled(std::span<const std::array<double, 3>> points) {
    const Eigen::Vector3d first(points[0].data());
    double reach = 0;
    for (const auto& p : points) reach = std::max(reach, (Eigen::Vector3d(p.data()) - first).cwiseAbs().maxCoeff());
    std::vector<Point> result;
    result.reserve(points.size());
    for (const auto& p : points) {
        result.emplace_back(Point::Zero());
        if (reach > 0 && std::isfinite(reach))
            result.back() = ((Eigen::Vector3d(p.data()) - first) / reach).cast<float>();
    }
    return result;
}

/// Sorts numbers of nodes into buckets, given that few are far from the mean.
class Buckets {
public:
    Buckets(float mean, float deviation)
        : lowest_(mean - reach * deviation), scale_(deviation > 0 ? (buckets - 1) / (2 * reach * deviation) : 0) {}
    [[nodiscard]] std::uint8_t operator()(float height) const {
        return static_cast<std::uint8_t>(std::clamp((height - lowest_) * scale_, 0.0F, buckets - 1.0F));
    }

private:
    static constexpr float reach = 2;  // an evenly thick bar has 1.7
    float lowest_, scale_;
};

class Dissector {
public:
    Dissector(const Graph& graph, bool with_points)
        : graph_(graph), with_points_(with_points), position_(static_cast<std::size_t>(graph.nodes())) {
        for (int n = 0; n <= graph.nodes(); ++n) reach_.push_back(std::cbrt(static_cast<float>(n) * n));
    }

    std::vector<int> run(std::vector<Point> points) {
        Piece whole{std::vector<int>(position_.size()), graph_, std::move(points)};
        std::iota(whole.node.begin(), whole.node.end(), 0);
        order(std::move(whole), 0);
        return std::move(position_);
    }

private:
    /// Assigns to the nodes of a piece the positions from `first` on. Calls have disjoint positions.
    void order(Piece piece, int first) {
        if (piece.size() <= leaf_nodes) return order_leaf(piece, first);
        std::vector<int> part;
        int parts = components(piece.graph, part);
        if (parts == 1) {
            const std::optional<std::vector<Side>> sides = separate(piece);
            if (!sides) return place(piece.node, first);
            parts = 2;
            for (std::size_t i = 0; i < part.size(); ++i) part[i] = static_cast<int>((*sides)[i]);
        }
        std::vector<Piece> pieces = divide(piece, part, parts);
        std::vector<int> separator;
        for (int i = 0; i < piece.size(); ++i) {
            if (part[i] >= parts) separator.push_back(piece.node[i]);
        }
        place(separator, first + piece.size() - static_cast<int>(separator.size()));
        order_each(std::move(pieces), first, piece.size());
    }

    void order_each(std::vector<Piece> pieces, int first, int nodes) {
        std::vector<int> firsts;
        for (const Piece& piece : pieces) {
            firsts.push_back(first);
            first += piece.size();
        }
        for_parts(pieces.size(), nodes, [&](std::size_t k) { order(std::move(pieces[k]), firsts[k]); });
    }

    /// Calls body(k) for each part of something with this many nodes, in parallel if that pays.
    template <class Body>
    static void for_parts(std::size_t parts, int nodes, const Body& body) {
        parallel_for(parts, nodes >= worth_sharing ? 1 : std::max<std::size_t>(parts, 1),
                     [&](std::size_t begin, std::size_t end) {
                         for (std::size_t k = begin; k < end; ++k) body(k);
                     });
    }

    void place(const std::vector<int>& nodes, int first) {
        for (const int node : nodes) position_[node] = first++;
    }

    void order_leaf(const Piece& piece, int first) {
        std::vector<Rim> rim;
        for (int i = 0; i < piece.size(); ++i) {
            if (!at_rim(piece, i)) continue;
            const int node = piece.node[i];
            for (int k = graph_.start[node]; k < graph_.start[node + 1]; ++k) {
                if (!std::binary_search(piece.node.begin(), piece.node.end(), graph_.other[k]))
                    rim.push_back({graph_.other[k], i});
            }
        }
        for (const int i : by_minimum_degree(piece.graph, std::move(rim))) position_[piece.node[i]] = first++;
    }

    /// True if a neighbour of the node is outside the piece.
    [[nodiscard]] bool at_rim(const Piece& piece, int i) const {
        return piece.graph.degree(i) != graph_.degree(piece.node[i]);
    }

    /// Connected components: their number, and the one of each node.
    static int components(const Graph& graph, std::vector<int>& part) {
        part.assign(static_cast<std::size_t>(graph.nodes()), -1);
        std::vector<int> stack;
        int count = 0;
        for (int root = 0; root < graph.nodes(); ++root) {
            if (part[root] >= 0) continue;
            part[root] = count;
            stack.assign(1, root);
            while (!stack.empty()) {
                const int i = stack.back();
                stack.pop_back();
                for (int k = graph.start[i]; k < graph.start[i + 1]; ++k) {
                    if (part[graph.other[k]] >= 0) continue;
                    part[graph.other[k]] = count;
                    stack.push_back(graph.other[k]);
                }
            }
            ++count;
        }
        return count;
    }

    /// The first `parts` parts of a piece as pieces; other nodes and edges between parts are left out.
    static std::vector<Piece> divide(const Piece& piece, const std::vector<int>& part, int parts) {
        std::vector<Piece> result(static_cast<std::size_t>(parts));
        std::vector<int> index(part.size());
        std::vector<std::vector<int>> members(result.size());
        for (int i = 0; i < piece.size(); ++i) {
            if (part[i] >= parts) continue;
            index[i] = static_cast<int>(members[part[i]].size());
            members[part[i]].push_back(i);
        }
        for_parts(result.size(), piece.size(), [&](std::size_t p) {
            Piece& own = result[p];
            own.graph.start.push_back(0);
            for (const int i : members[p]) {
                own.node.push_back(piece.node[i]);
                own.point.push_back(piece.point[i]);
                for (int k = piece.graph.start[i]; k < piece.graph.start[i + 1]; ++k) {
                    if (part[piece.graph.other[k]] == part[i]) own.graph.other.push_back(index[piece.graph.other[k]]);
                }
                own.graph.start.push_back(static_cast<int>(own.graph.other.size()));
            }
        });
        return result;
    }

    /// A separator, or none if there is no good one: then nearly all nodes are adjacent.
    [[nodiscard]] std::optional<std::vector<Side>> separate(const Piece& piece) const {
        std::vector<Heights> heights = heights_of(piece);
        if (!with_points_) set_levels(piece.graph, heights);
        Cut cut = best_cut(piece, heights);
        if (with_points_ && !std::isfinite(cut.cost)) {
            set_levels(piece.graph, heights);
            cut = best_cut(piece, heights);
        }
        if (!std::isfinite(cut.cost)) return std::nullopt;
        const auto half = [&](std::size_t i) { return heights[i][cut.field] <= cut.height ? Side::left : Side::right; };
        std::vector<Side> sides(heights.size());
        for_nodes(sides.size(), [&](std::size_t i) {
            sides[i] = half(i);
            for (int k = piece.graph.start[i]; sides[i] == cut.from && k < piece.graph.start[i + 1]; ++k) {
                if (half(static_cast<std::size_t>(piece.graph.other[k])) != cut.from) sides[i] = Side::separator;
            }
        });
        shrink_separator(piece.graph, sides, least_side_of(piece.size()));
        return sides;
    }

    template <class Body>
    static void for_nodes(std::size_t nodes, const Body& body) {
        parallel_for(nodes, nodes_at_once, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) body(i);
        });
    }

    static int least_side_of(int nodes) { return std::max(1, static_cast<int>(least_side * nodes)); }

    /// Heights along the axes of inertia and the coordinate axes.
    static std::vector<Heights> heights_of(const Piece& piece) {
        Point mean = Point::Zero();
        for (const Point& p : piece.point) mean += p;
        mean /= static_cast<float>(piece.size());
        Eigen::Matrix3f spread = Eigen::Matrix3f::Zero();
        for (const Point& p : piece.point) spread += (p - mean) * (p - mean).transpose();
        spread /= static_cast<float>(piece.size());
        Eigen::Matrix<float, planes, 3> direction;
        direction << Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>().computeDirect(spread).eigenvectors().transpose(),
            Eigen::Matrix3f::Identity();
        std::vector<Buckets> bucket;
        for (Eigen::Index d = 0; d < direction.rows(); ++d) {
            const float variance = direction.row(d) * spread * direction.row(d).transpose();
            bucket.emplace_back(direction.row(d) * mean, std::sqrt(std::max(variance, 0.0F)));
        }
        std::vector<Heights> heights(piece.point.size());
        for_nodes(heights.size(), [&](std::size_t i) {
            const Eigen::Matrix<float, planes, 1> along = direction * piece.point[i];
            for (std::size_t d = 0; d < planes; ++d) heights[i][d] = bucket[d](along[static_cast<Eigen::Index>(d)]);
        });
        return heights;
    }

    /// Distances along edges from one end of the piece.
    static void set_levels(const Graph& graph, std::vector<Heights>& heights) {
        std::vector<int> order;
        std::ignore = distances(graph, 0, order);
        const std::vector<int> level = distances(graph, order.back(), order);
        const float scale = (buckets - 1.0F) / std::max(1.0F, static_cast<float>(level[order.back()]));
        for (std::size_t i = 0; i < heights.size(); ++i)
            heights[i][level_field] = static_cast<std::uint8_t>(static_cast<float>(level[i]) * scale);
    }

    /// The number of nodes in each bucket of a field, how many of them are at the rim of the piece, and for which cuts
    /// a node is adjacent to the other side (cumulative over buckets).
    struct Counts {
        std::array<int, buckets> nodes{}, rim{}, left{}, right{};
        void add(const Counts& other) {
            for (const auto part : {&Counts::nodes, &Counts::rim, &Counts::left, &Counts::right}) {
                for (std::size_t k = 0; k < buckets; ++k) (this->*part)[k] += (other.*part)[k];
            }
        }
    };

    [[nodiscard]] Cut best_cut(const Piece& piece, const std::vector<Heights>& heights) const {
        using AllCounts = std::array<Counts, fields>;
        std::vector<AllCounts> parts((heights.size() + nodes_at_once - 1) / nodes_at_once);
        parallel_for(heights.size(), nodes_at_once, [&](std::size_t begin, std::size_t end) {
            count(piece, heights, begin, end, parts[begin / nodes_at_once]);
        });
        for (std::size_t p = 1; p < parts.size(); ++p) {
            for (std::size_t f = 0; f < fields; ++f) parts[0][f].add(parts[p][f]);
        }
        Cut best;
        for (std::size_t f = 0; f < fields; ++f) consider(parts[0][f], piece.size(), f, best);
        return best;
    }

    /// Counts nodes `begin` to `end` of a piece.
    void count(const Piece& piece, const std::vector<Heights>& heights, std::size_t begin, std::size_t end,
               std::array<Counts, fields>& counts) const {
        for (auto i = static_cast<int>(begin); i < static_cast<int>(end); ++i) {
            const Heights own = heights[i];
            Heights lowest = own;
            Heights highest = own;
            for (int k = piece.graph.start[i]; k < piece.graph.start[i + 1]; ++k) {
                const Heights other = heights[piece.graph.other[k]];
                lowest = other < lowest ? other : lowest;
                highest = other > highest ? other : highest;
            }
            const int rim = at_rim(piece, i) ? 1 : 0;
            for (std::size_t f = 0; f < fields; ++f) {
                Counts& c = counts[f];
                ++c.nodes[own[f]];
                c.rim[own[f]] += rim;
                ++c.left[own[f]];
                --c.left[highest[f]];
                ++c.right[lowest[f]];
                --c.right[own[f]];
            }
        }
    }

    void consider(const Counts& counts, int nodes, std::size_t field, Cut& best) const {
        const int rim = std::accumulate(counts.rim.begin(), counts.rim.end(), 0);
        int below = 0, rim_below = 0, left = 0, right = 0;
        for (int height = 0; height + 1 < buckets; ++height) {
            below += counts.nodes[height];
            rim_below += counts.rim[height];
            left += counts.left[height];
            right += counts.right[height];
            if (counts.nodes[height] == 0) continue;
            for (const Side from : {Side::left, Side::right}) {
                const int separator = from == Side::left ? left : right;
                const int a = below - (from == Side::left ? separator : 0);
                const int b = nodes - separator - a;
                if (std::min(a, b) < least_side_of(nodes)) continue;
                const double cost = work_of_separator(separator, rim) + work_of_part(a, rim_below + separator) +
                                    work_of_part(b, rim - rim_below + separator);
                if (cost < best.cost) best = {cost, field, height, from};
            }
        }
    }

    /// Multiply-adds to eliminate a separator whose columns reach `rim` nodes.
    static double work_of_separator(double nodes, double rim) {
        return nodes * (nodes * nodes / 3 + nodes * rim + rim * rim);
    }

    /// An estimate: columns of a part are as long as its own separators, which grow with its cross-section, and its
    /// rim. It penalises parts of unequal size or rim.
    [[nodiscard]] double work_of_part(int nodes, double rim) const {
        const double column = 0.3 * static_cast<double>(reach_[nodes]) + rim;
        return 0.5 * nodes * column * column;
    }

    const Graph& graph_;
    bool with_points_;
    std::vector<float> reach_;  ///< (nodes + 1) n^(2/3)
    std::vector<int> position_;
};

}  // namespace

std::vector<int> dissect(const Graph& graph, std::span<const std::array<double, 3>> points) {
    if (graph.nodes() == 0) return {};
    return Dissector(graph, !points.empty()).run(points.empty() ? points_by_distance(graph) : scaled(points));
}

}  // namespace pliant::linalg
