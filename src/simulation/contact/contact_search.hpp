// What Contact's queries share, inside this folder: the sweep over features whose boxes overlap, and its cache.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/core/parallel.hpp"
#include "simulation/contact/clearance.hpp"
#include "simulation/contact/contact.hpp"

namespace pliant::sim::contact {

/// Share of its present distance that every pair keeps in a step.
inline constexpr double kept_share = 0.1;

inline Stencil stencil_at(std::span<const int> nodes, std::span<const double> x) {
    return {node_at(x, nodes[0]), node_at(x, nodes[1]), node_at(x, nodes[2]), node_at(x, nodes[3])};
}

/// Calls visit(node) for the nodes of a feature.
template <class Nodes, class Visit>
void for_nodes(const Nodes& feature, const Visit& visit) {
    if constexpr (std::is_same_v<Nodes, int>) {
        visit(feature);
    } else {
        for (const int node : feature) visit(node);
    }
}

/// Boxes of the features' points at x or, if dx is given, at x + dx.
template <class Nodes>
std::vector<Bounds> boxes_of(const std::vector<Nodes>& features, std::span<const double> x, std::span<const double> dx,
                             double margin) {
    std::vector<Bounds> boxes(features.size());
    for (std::size_t f = 0; f < features.size(); ++f) {
        for_nodes(features[f], [&](int node) {
            const Vec3 p = node_at(x, node);
            boxes[f].add(dx.empty() ? p : p + node_at(dx, node));
        });
        boxes[f].widen(margin);
    }
    return boxes;
}

/// Whether each feature has a node that moves.
template <class Nodes>
std::vector<char> moving_ones(const std::vector<Nodes>& features, std::span<const double> dx) {
    std::vector<char> moves(features.size(), 0);
    for (std::size_t f = 0; f < features.size(); ++f) {
        for_nodes(features[f], [&](int node) {
            if (node_at(dx, node) != Vec3{}) moves[f] = 1;
        });
    }
    return moves;
}

/// Features of one kind of one side.
struct Group {
    const BoxTree* tree;
    std::shared_ptr<const BoxTree::MovingFit> fit;  ///< without an end in a search without a motion
};

enum class Shape { points, edges, triangles };

/// Boxes of obstacles that have not moved since they were fitted, by what they were fitted for: most obstacles never
/// move, and round ones have many more features than the robot.
class StillBoxes {
public:
    struct Use {
        Shape shape;
        double margin;
        bool in_motion;  ///< with an end
        auto operator<=>(const Use&) const = default;
    };
    using Fit = std::shared_ptr<const BoxTree::MovingFit>;

    /// The fit for this use with the points at `at`; null if it is not known.
    [[nodiscard]] Fit find(const Use& use, const std::vector<Vec3>& at) const {
        const std::lock_guard lock(mutex_);
        const auto known = fits_.find(use);
        return known == fits_.end() || at_ != at ? nullptr : known->second;
    }
    void keep(const Use& use, const std::vector<Vec3>& at, Fit fit) {
        const std::lock_guard lock(mutex_);
        if (at_ != at || fits_.size() >= most) fits_.clear();
        at_ = at;
        fits_[use] = std::move(fit);
    }

private:
    static constexpr std::size_t most = 24;
    mutable std::mutex mutex_;  // not that of Memory, which is held while a Nearby searches
    std::vector<Vec3> at_;
    std::map<Use, Fit> fits_;
};

struct Contact::Memory {
    std::mutex mutex;
    std::vector<double> x;  ///< at the last call
    std::shared_ptr<const Nearby> nearby;
    int settled = 0;  ///< number of consecutive calls near the previous one
    struct {
        std::vector<double> x;
        Pairs pairs;
    } found;  ///< result of the last find: a solver asks several times for the same state
    StillBoxes still;
    std::map<std::pair<std::int64_t, int>, double> from_face_m;  ///< Contact::rest_distance(), by face and point

    /// The clearance at a state where nothing was near, and how useful it was.
    struct {
        std::shared_ptr<const Clearance> known;
        std::vector<double> end;  ///< a state known to be clear: the end of a step
        int served = 0;           ///< number of calls that it has answered
        int wait = 0;             ///< number of searches before the next attempt
        int patience = 1;

        void grow_patience() { wait = patience = std::min(2 * patience, 64); }
    } clear;
};

class Contact::Search {
public:
    enum class What { pairs, crossings };

    /// `margin`: largest distance of features that are found; with `dx` also those that come so near on the way to x +
    /// dx.
    Search(const Contact& contact, std::span<const double> x, std::span<const double> dx, double margin, What what,
           bool self)
        : contact_(contact), x_(x), dx_(dx), margin_(margin) {
        const Kind first = what == What::crossings ? Kind::edge_triangle : Kind::point_triangle;
        std::vector<std::pair<std::size_t, std::size_t>> meetings = contact.meetings(self);
        // The robot itself comes first.
        std::rotate(meetings.begin(), meetings.end() - (self ? 1 : 0), meetings.end());
        std::erase_if(meetings, [&](const auto& m) { return !are_near(m.first, m.second); });
        for (const auto& [a, b] : meetings) {
            add(first, a, b);
            if (a != b) add(first, b, a);
        }
        if (what == What::crossings) return;
        for (const auto& [a, b] : meetings) add(Kind::edge_edge, a, b);
    }

    enum class Kind { point_triangle, edge_edge, edge_triangle };
    /// Two features; for the first two kinds without a common node.
    struct Candidate {
        Kind kind = Kind::point_triangle;
        std::array<int, 5> nodes{};   ///< 4 for the first two kinds
        double area_m2 = 0;           ///< of the smaller feature
        std::int64_t flat_face = -1;  ///< as in Surface; point_triangle alone

        [[nodiscard]] Features features() const {
            return kind == Kind::edge_edge ? Features::edge_edge : Features::point_triangle;
        }
        /// False only if the boxes of both features stay further apart than `margin` all along dx.
        [[nodiscard]] bool comes_near(std::span<const double> x, std::span<const double> dx, double margin) const {
            const std::size_t firsts = kind == Kind::edge_edge ? 2 : 1;
            MovingBounds first, second;
            for (std::size_t k = 0; k < 4; ++k) {
                MovingBounds& own = k < firsts ? first : second;
                const Vec3 p = node_at(x, nodes[k]);
                own.start.add(p);
                own.end.add(p + node_at(dx, nodes[k]));
            }
            first.start.widen(margin);
            first.end.widen(margin);
            return first.may_meet(second);
        }
        [[nodiscard]] std::span<const int> first_nodes() const {
            return std::span(nodes).first(kind == Kind::edge_edge ? 2 : 1);
        }
        [[nodiscard]] std::span<const int> second_nodes() const {
            return std::span(nodes).first(4).subspan(first_nodes().size());
        }
        [[nodiscard]] double distance_bound(std::span<const double> x) const {
            return contact::distance_bound(features(), stencil_at(std::span(nodes).first<4>(), x));
        }
        [[nodiscard]] double squared_distance(std::span<const double> x) const {
            const Stencil at = stencil_at(std::span(nodes).first<4>(), x);
            return contact::squared_distance(nearest(features(), at), at);
        }
    };

    /// Calls visit(candidate, result) for all candidates; each chunk of leaves begins with its own `start`. Results in
    /// order.
    template <class Result, class Visit>
    [[nodiscard]] std::vector<Result> run(const Result& start, const Visit& visit) const {
        constexpr std::size_t grain = 64;
        std::vector<Result> results((leaf_count_ + grain - 1) / grain, start);
        parallel_for(leaf_count_, grain, [&](std::size_t begin, std::size_t end) {
            Result& result = results[begin / grain];
            for (const Family& family : families_) {
                const std::size_t from = std::max(begin, family.first_leaf);
                const std::size_t to = std::min(end, family.first_leaf + family.first->tree->leaf_count());
                for (std::size_t l = from; l < to; ++l)
                    look(family, l - family.first_leaf, [&](const Candidate& c) { visit(c, result); });
            }
        });
        return results;
    }

private:
    struct Family {
        Kind kind;
        const Side *first_side, *second_side;
        const Group *first, *second;
        std::size_t first_leaf;  ///< leaves of all families are numbered through
    };

    [[nodiscard]] static const BoxTree& tree_of(Shape shape, const Side& side) {
        return shape == Shape::points ? side.points : shape == Shape::edges ? side.edges : side.triangles;
    }

    template <class Nodes>
    [[nodiscard]] BoxTree::MovingFit fitted(const BoxTree& tree, const std::vector<Nodes>& features) const {
        const std::vector<Bounds> start = boxes_of(features, x_, {}, margin_ / 2);
        if (dx_.empty()) return {tree.fit(start), {}, {}};
        return tree.fit(start, boxes_of(features, x_, dx_, margin_ / 2), moving_ones(features, dx_));
    }

    [[nodiscard]] Group fitted(Shape shape, const Side& side) const {
        const BoxTree& tree = tree_of(shape, side);
        BoxTree::MovingFit fit = shape == Shape::points  ? fitted(tree, side.surface.points)
                                 : shape == Shape::edges ? fitted(tree, side.surface.edges)
                                                         : fitted(tree, side.surface.triangles);
        return {&tree, std::make_shared<const BoxTree::MovingFit>(std::move(fit))};
    }

    /// Where the points of the obstacles are, unless one of them moves.
    [[nodiscard]] std::optional<std::vector<Vec3>> still_obstacles() const {
        std::vector<Vec3> at;
        for (const int point : contact_.others_.surface.points) {
            if (!dx_.empty() && node_at(dx_, point) != Vec3{}) return std::nullopt;
            at.push_back(node_at(x_, point));
        }
        return at;
    }

    /// Of the obstacles.
    [[nodiscard]] Group known_or_fitted(Shape shape) {
        const Side& side = contact_.others_;
        if (!asked_for_obstacles_) obstacles_ = still_obstacles();
        asked_for_obstacles_ = true;
        if (!obstacles_) return fitted(shape, side);
        const StillBoxes::Use use{shape, margin_, !dx_.empty()};
        StillBoxes& known = contact_.memory_->still;
        if (auto fit = known.find(use, *obstacles_)) return {&tree_of(shape, side), std::move(fit)};
        Group group = fitted(shape, side);
        known.keep(use, *obstacles_, group.fit);
        return group;
    }

    /// The group, built on first use.
    const Group& group(Shape shape, std::size_t k) {
        const auto [entry, fresh] = groups_.try_emplace({shape, k});
        if (!fresh) return entry->second;
        constexpr std::size_t obstacles = 1;
        entry->second = k == obstacles ? known_or_fitted(shape) : fitted(shape, contact_.side(k));
        return entry->second;
    }

    void add(Kind kind, std::size_t a, std::size_t b) {
        const Side &first = contact_.side(a), &second = contact_.side(b);
        if (first.surface.triangles.empty() || second.surface.triangles.empty()) return;
        const Group& firsts = group(kind == Kind::point_triangle ? Shape::points : Shape::edges, a);
        const Group& seconds = group(kind == Kind::edge_edge ? Shape::edges : Shape::triangles, b);
        families_.push_back({kind, &first, &second, &firsts, &seconds, leaf_count_});
        leaf_count_ += firsts.tree->leaf_count();
    }

    /// Quick rejection, as rigid parts are many and far apart: false if the boxes of two sides are not near each other.
    [[nodiscard]] bool are_near(std::size_t a, std::size_t b) {
        return contact_.rigid_.empty() || a == b || box(a).overlaps(box(b));
    }
    const Bounds& box(std::size_t k) {
        const auto [entry, fresh] = boxes_.try_emplace(k);
        if (!fresh) return entry->second;
        for (const int point : contact_.side(k).surface.points) {
            const Vec3 p = node_at(x_, point);
            entry->second.add(p);
            if (!dx_.empty()) entry->second.add(p + node_at(dx_, point));
        }
        entry->second.widen(margin_ / 2);
        return entry->second;
    }

    /// Calls visit(candidate) for all candidates of leaf `l` of the first features.
    template <class Visit>
    void look(const Family& f, std::size_t l, const Visit& visit) const {
        const Group &a = *f.first, &b = *f.second;
        const auto found = [&](int i, int j) { offer(f, i, j, visit); };
        if (a.fit->end.nodes.empty())
            a.tree->visit_overlaps(a.fit->start, l, *b.tree, b.fit->start, found);
        else
            a.tree->visit_meetings(*a.fit, l, *b.tree, *b.fit, found);
    }

    template <class Visit>
    void offer(const Family& f, int i, int j, const Visit& visit) const {
        const Surface &a = f.first_side->surface, &b = f.second_side->surface;
        switch (f.kind) {
            case Kind::point_triangle: {
                const int p = a.points[i];
                const auto& t = b.triangles[j];
                if (!a.acts(static_cast<std::size_t>(i))) return;
                if (p == t[0] || p == t[1] || p == t[2]) return;
                const double area = std::min(f.first_side->areas.points[i], f.second_side->areas.triangles[j]);
                visit(Candidate{f.kind, {p, t[0], t[1], t[2], -1}, area, b.flat_face.empty() ? -1 : b.flat_face[j]});
                return;
            }
            case Kind::edge_edge: {
                const auto &e = a.edges[i], &g = b.edges[j];
                if (e[0] == g[0] || e[0] == g[1] || e[1] == g[0] || e[1] == g[1]) return;
                const double area = std::min(f.first_side->areas.edges[i], f.second_side->areas.edges[j]);
                visit(Candidate{f.kind, {e[0], e[1], g[0], g[1], -1}, area});
                return;
            }
            case Kind::edge_triangle: {
                const auto& e = a.edges[i];
                const auto& t = b.triangles[j];
                visit(Candidate{f.kind, {e[0], e[1], t[0], t[1], t[2]}, 0});
                return;
            }
        }
    }

    const Contact& contact_;
    std::span<const double> x_, dx_;
    double margin_;
    std::map<std::pair<Shape, std::size_t>, Group> groups_;
    std::map<std::size_t, Bounds> boxes_;
    std::optional<std::vector<Vec3>> obstacles_;  ///< as still_obstacles(), once it was asked
    bool asked_for_obstacles_ = false;
    std::vector<Family> families_;
    std::size_t leaf_count_ = 0;
};

/// All candidates within the distance at which forces act, valid for states in which no node has moved by more than the
/// slack along any axis; in the order of a search.
class Contact::Nearby {
public:
    Nearby(const Contact& contact, std::span<const double> x) : x_(x.begin(), x.end()), slack_m_(slack(contact)) {
        const Search search(contact, x, {}, contact.settings_.distance_m + 2 * slack_m_, Search::What::pairs,
                            contact.settings_.self);
        using List = std::vector<Search::Candidate>;
        const auto keep = [](const Search::Candidate& c, List& list) { list.push_back(c); };
        for (const List& piece : search.run(List{}, keep))
            candidates_.insert(candidates_.end(), piece.begin(), piece.end());
    }

    /// Motion of a node along an axis, after which the search is repeated.
    [[nodiscard]] static double slack(const Contact& contact) { return slack_share * contact.settings_.distance_m; }
    /// True if valid for x, and for x + dx if dx is given.
    [[nodiscard]] bool holds(std::span<const double> x, std::span<const double> dx) const {
        return are_within(x_, x, dx, slack_m_);
    }
    /// True if no number of x, nor of x + dx, is further than `slack_m` from that of `from`.
    [[nodiscard]] static bool are_within(std::span<const double> from, std::span<const double> x,
                                         std::span<const double> dx, double slack_m) {
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (!(std::fabs(x[i] - from[i]) <= slack_m)) return false;
            if (!dx.empty() && !(std::fabs(x[i] + dx[i] - from[i]) <= slack_m)) return false;
        }
        return true;
    }

    /// As Search::run().
    template <class Result, class Visit>
    [[nodiscard]] std::vector<Result> run(const Result& start, const Visit& visit) const {
        constexpr std::size_t grain = 1024;
        std::vector<Result> results((candidates_.size() + grain - 1) / grain, start);
        parallel_for(candidates_.size(), grain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) visit(candidates_[k], results[begin / grain]);
        });
        return results;
    }

private:
    static constexpr double slack_share = 0.5;  // of the distance at which forces act

    std::vector<double> x_;
    double slack_m_;
    std::vector<Search::Candidate> candidates_;
};

}  // namespace pliant::sim::contact
