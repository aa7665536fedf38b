// What needs a look at every two features that are near each other: pairs, steps, crossings.
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <utility>

#include "base/core/parallel.hpp"
#include "simulation/contact/clearance.hpp"
#include "simulation/contact/contact.hpp"
#include "simulation/contact/intersection.hpp"

namespace pliant::sim::contact {

namespace {

/// A tenth: the share of its present distance that a step leaves to every pair.
constexpr double kept_share = 0.1;

/// After so many calls near each other it is worth knowing what is near.
constexpr int settled_calls = 2;

/// How far a node may go, in distances at which forces act, before what was near is looked for again.
constexpr double slack_share = 0.5;

Stencil stencil_at(std::span<const int> nodes, std::span<const double> x) {
    return {node_at(x, nodes[0]), node_at(x, nodes[1]), node_at(x, nodes[2]), node_at(x, nodes[3])};
}

/// Boxes of the features' points at x or, where dx is given, at x + dx.
template <class Nodes>
std::vector<Bounds> boxes_of(const std::vector<Nodes>& features, std::span<const double> x, std::span<const double> dx,
                             double margin) {
    std::vector<Bounds> boxes(features.size());
    for (std::size_t f = 0; f < features.size(); ++f) {
        const auto add = [&](int node) {
            const Vec3 p = node_at(x, node);
            boxes[f].add(dx.empty() ? p : p + node_at(dx, node));
        };
        if constexpr (std::is_same_v<Nodes, int>) {
            add(features[f]);
        } else {
            for (const int node : features[f]) add(node);
        }
        boxes[f].widen(margin);
    }
    return boxes;
}

/// Features of one kind of one side.
struct Group {
    const BoxTree* tree;
    BoxTree::MovingFit fit;  ///< without an end where nothing moves
};

}  // namespace

class Contact::Search {
public:
    enum class What { pairs, crossings };

    /// `margin`: how far apart features may be and still be found; with `dx` those that come so near on the way from x
    /// to x + dx.
    Search(const Contact& contact, std::span<const double> x, std::span<const double> dx, double margin, What what,
           bool self) {
        const Side &robot = contact.robot_, &others = contact.others_;
        const auto points = [&](const Side& s) { return group(s.points, s.surface.points, x, dx, margin / 2); };
        const auto edges = [&](const Side& s) { return group(s.edges, s.surface.edges, x, dx, margin / 2); };
        const auto triangles = [&](const Side& s) {
            return group(s.triangles, s.surface.triangles, x, dx, margin / 2);
        };
        const bool crossings = what == What::crossings;
        groups_[0] = {crossings ? edges(robot) : points(robot), crossings ? edges(others) : points(others)};
        groups_[1] = {triangles(robot), triangles(others)};
        const Kind kind = crossings ? Kind::edge_triangle : Kind::point_triangle;
        if (self) add(kind, robot, robot, groups_[0][0], groups_[1][0]);
        add(kind, robot, others, groups_[0][0], groups_[1][1]);
        add(kind, others, robot, groups_[0][1], groups_[1][0]);
        if (crossings) return;
        groups_[2] = {edges(robot), edges(others)};
        if (self) add(Kind::edge_edge, robot, robot, groups_[2][0], groups_[2][0]);
        add(Kind::edge_edge, robot, others, groups_[2][0], groups_[2][1]);
    }

    enum class Kind { point_triangle, edge_edge, edge_triangle };
    /// Two features; of the first two kinds they share no node.
    struct Candidate {
        Kind kind = Kind::point_triangle;
        std::array<int, 5> nodes{};  ///< 4 of the first two kinds
        double area_m2 = 0;          ///< of the smaller feature

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

    /// Calls visit(candidate, result) for all, each piece of leaves with its own `start`; the results in order.
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

    template <class Nodes>
    static Group group(const BoxTree& tree, const std::vector<Nodes>& features, std::span<const double> x,
                       std::span<const double> dx, double margin) {
        Group group{&tree, {tree.fit(boxes_of(features, x, {}, margin)), {}}};
        if (!dx.empty()) group.fit.end = tree.fit(boxes_of(features, x, dx, margin));
        return group;
    }

    void add(Kind kind, const Side& first_side, const Side& second_side, const Group& first, const Group& second) {
        if (first.tree->leaf_count() == 0 || second.tree->leaf_count() == 0) return;
        families_.push_back({kind, &first_side, &second_side, &first, &second, leaf_count_});
        leaf_count_ += first.tree->leaf_count();
    }

    /// Calls visit(candidate) for what leaf `l` of the first features finds.
    template <class Visit>
    void look(const Family& f, std::size_t l, const Visit& visit) const {
        const Group &a = *f.first, &b = *f.second;
        const auto found = [&](int i, int j) { offer(f, i, j, visit); };
        if (a.fit.end.nodes.empty())
            a.tree->visit_overlaps(a.fit.start, l, *b.tree, b.fit.start, found);
        else
            a.tree->visit_meetings(a.fit, l, *b.tree, b.fit, found);
    }

    template <class Visit>
    void offer(const Family& f, int i, int j, const Visit& visit) const {
        const Surface &a = f.first_side->surface, &b = f.second_side->surface;
        switch (f.kind) {
            case Kind::point_triangle: {
                const int p = a.points[i];
                const auto& t = b.triangles[j];
                if (p == t[0] || p == t[1] || p == t[2]) return;
                const double area = std::min(f.first_side->areas.points[i], f.second_side->areas.triangles[j]);
                visit(Candidate{f.kind, {p, t[0], t[1], t[2], -1}, area});
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

    std::array<std::array<Group, 2>, 3> groups_{};  ///< points or edges, triangles, edges; robot, obstacles
    std::vector<Family> families_;
    std::size_t leaf_count_ = 0;
};

/// All candidates within the distance at which forces act of any state in which no node is further than the slack from
/// where it was, on any axis; in the order of a search.
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

    [[nodiscard]] static double slack(const Contact& contact) { return slack_share * contact.settings_.distance_m; }
    /// Good for x, and for x + dx where dx is given.
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
    std::vector<double> x_;
    double slack_m_;
    std::vector<Search::Candidate> candidates_;
};

struct Contact::Memory {
    std::mutex mutex;
    std::vector<double> x;  ///< of the last call
    std::shared_ptr<const Nearby> nearby;
    int settled = 0;  ///< calls in a row that were near the one before
    struct {
        std::vector<double> x;
        Pairs pairs;
    } found;  ///< by the last find: a solver asks several times for one state

    /// Where nothing was near, and how useful that was to know.
    struct {
        std::shared_ptr<const Clearance> known;
        std::vector<double> end;  ///< a state that is known to be clear: where a step ended
        int served = 0;           ///< calls that it has answered
        int wait = 0;             ///< searches before it is worth trying again
        int patience = 1;

        void grow_patience() { wait = patience = std::min(2 * patience, 64); }
    } clear;
};

namespace {

/// A clearance that answers fewer calls than this has cost more than it spared.
constexpr int worth_knowing = 4;

}  // namespace

Contact::Contact() : memory_(std::make_shared<Memory>()) {}

/// A state far from the last one is likely to be left behind at once, and a step that ends in one iteration asks twice
/// where it begins; from the third call near each other on, knowing pays.
std::shared_ptr<const Contact::Nearby> Contact::nearby(std::span<const double> x, std::span<const double> dx) const {
    const std::lock_guard lock(memory_->mutex);
    Memory& memory = *memory_;
    if (memory.nearby && memory.nearby->holds(x, dx)) return memory.nearby;
    const double slack_m = Nearby::slack(*this);
    const bool settles = memory.x.size() == x.size() && Nearby::are_within(memory.x, x, {}, slack_m) &&
                         Nearby::are_within(x, x, dx, slack_m);
    memory.x.assign(x.begin(), x.end());
    memory.settled = settles ? memory.settled + 1 : 0;
    if (memory.settled < settled_calls) return nullptr;
    return memory.nearby = std::make_shared<const Nearby>(*this, x);
}

bool Contact::is_clear(std::span<const double> x, std::span<const double> dx) const {
    std::shared_ptr<const Clearance> known;
    {
        const std::lock_guard lock(memory_->mutex);
        if (!memory_->clear.known) return false;
        if (dx.empty() && std::ranges::equal(memory_->clear.end, x)) return true;
        known = memory_->clear.known;
    }
    const bool holds = known->holds(x, dx);
    const std::lock_guard lock(memory_->mutex);
    auto& clear = memory_->clear;
    if (holds) {
        ++clear.served;
        clear.end.assign(x.begin(), x.end());
        for (std::size_t i = 0; i < dx.size(); ++i) clear.end[i] += dx[i];
        return true;
    }
    if (clear.known != known) return false;
    if (clear.served >= worth_knowing)
        clear.patience = 1, clear.wait = 0;
    else
        clear.grow_patience();
    clear.known.reset();
    clear.end.clear();
    return false;
}

void Contact::wait_for_clearance() const {
    const std::lock_guard lock(memory_->mutex);
    memory_->clear.grow_patience();
}

void Contact::note_clearance(std::span<const double> x) const {
    {
        const std::lock_guard lock(memory_->mutex);
        if (memory_->clear.known || memory_->clear.wait-- > 0) return;
    }
    struct Seen {
        Search::Candidate candidate;
        double now_m, rest_m;  ///< apart
    };
    const auto look = [&](const Search::Candidate& c, std::vector<Seen>& seen) {
        if (c.distance_bound(x) >= seen_m_) return;
        const double now = std::sqrt(c.squared_distance(x)), rest = std::sqrt(c.squared_distance(rest_));
        if (now < seen_m_ && !belonging_.together(c.first_nodes(), c.second_nodes(), rest))
            seen.push_back({c, now, rest});
    };
    const Search search(*this, x, {}, seen_m_, Search::What::pairs, settings_.self);
    std::vector<Seen> all;
    for (const std::vector<Seen>& piece : search.run(std::vector<Seen>{}, look))
        all.insert(all.end(), piece.begin(), piece.end());
    const auto reach_of = [&](const Seen& s) { return reach(obstacle_of(s.candidate.nodes), s.rest_m); };
    if (std::ranges::any_of(all, [&](const Seen& s) { return s.now_m <= reach_of(s); })) return wait_for_clearance();
    const std::array<Clearance::Side, 2> sides{
        {{&robot_.surface, robot_.regions}, {&others_.surface, others_.regions}}};
    const std::array<Clearance::Meeting, 2> meetings{{{0, 1}, {0, 0}}};
    Clearance clearance(sides, std::span(meetings).first(settings_.self ? 2 : 1), x, seen_m_, settings_.distance_m);
    for (const Seen& seen : all) {
        const bool robot_first = obstacle_of_node_[seen.candidate.nodes[0]] < 0;
        const auto first = seen.candidate.first_nodes(), second = seen.candidate.second_nodes();
        clearance.offer(obstacle_of(seen.candidate.nodes) < 0 ? 1 : 0, robot_first ? first : second,
                        robot_first ? second : first, seen.now_m, reach_of(seen));
    }
    const std::lock_guard lock(memory_->mutex);
    memory_->clear.known = std::make_shared<const Clearance>(std::move(clearance));
    memory_->clear.end.assign(x.begin(), x.end());
    memory_->clear.served = 0;
}

Pairs Contact::find(std::span<const double> x) const {
    {
        const std::lock_guard lock(memory_->mutex);
        if (std::ranges::equal(memory_->found.x, x)) return memory_->found.pairs;
    }
    const bool clear = is_clear(x, {});
    Pairs pairs = clear ? Pairs{} : search_pairs(x);
    if (!clear && pairs.empty()) note_clearance(x);
    find_planes(x, pairs);
    const std::lock_guard lock(memory_->mutex);
    memory_->found.x.assign(x.begin(), x.end());
    memory_->found.pairs = pairs;
    return pairs;
}

Pairs Contact::search_pairs(std::span<const double> x) const {
    const double most = settings_.distance_m;
    const auto consider = [&](const Search::Candidate& c, Pairs& found) {
        if (c.distance_bound(x) >= most) return;
        const double squared = c.squared_distance(x);
        if (squared >= most * most) return;
        const double apart = std::sqrt(c.squared_distance(rest_));
        const double reach = this->reach(obstacle_of(c.nodes), apart);
        if (squared < reach * reach && !belonging_.together(c.first_nodes(), c.second_nodes(), apart))
            found.push_back(make_pair(c.features() == Features::edge_edge, c.nodes, reach, c.area_m2));
    };
    const auto known = nearby(x, {});
    const std::vector<Pairs> pieces =
        known ? known->run(Pairs{}, consider)
              : Search(*this, x, {}, most, Search::What::pairs, settings_.self).run(Pairs{}, consider);
    Pairs pairs;
    for (const Pairs& piece : pieces) pairs.insert(pairs.end(), piece.begin(), piece.end());
    return pairs;
}

int Contact::obstacle_of(std::span<const int> nodes) const {
    return std::max(obstacle_of_node_[nodes[0]], obstacle_of_node_[nodes[3]]);
}

double Contact::reach(int obstacle, double apart_m) const {
    return std::min(settings_.distance_m, obstacle < 0 || drawn_in_m_[obstacle] == 0 ? 0.5 * apart_m : apart_m);
}

Pair Contact::make_pair(bool edges, std::span<const int> nodes, double reach_m, double area_m2) const {
    Pair pair;
    pair.kind = edges ? PairKind::edge_edge : PairKind::point_triangle;
    std::copy_n(nodes.begin(), 4, pair.nodes.begin());
    pair.obstacle = obstacle_of(nodes);
    pair.robot_first = obstacle_of_node_[nodes[0]] < 0;
    pair.reach_m = reach_m;
    // Every place of a surface counts as part of a point and of a triangle, and again as part of an edge.
    pair.area_m2 = area_m2 / 2;
    const Vec3 u = node_at(rest_, nodes[1]) - node_at(rest_, nodes[0]);
    const Vec3 v = node_at(rest_, nodes[3]) - node_at(rest_, nodes[2]);
    pair.parallel_m4 = 1e-3 * dot(u, u) * dot(v, v);
    return pair;
}

void Contact::find_planes(std::span<const double> x, Pairs& pairs) const {
    for (const Plane& plane : planes_) {
        for (std::size_t i = 0; i < robot_.surface.points.size(); ++i) {
            const int point = robot_.surface.points[i];
            Pair pair;
            pair.kind = PairKind::point_plane;
            pair.nodes = {point, plane.node, plane.node, plane.node};
            pair.obstacle = plane.obstacle;
            pair.normal = plane.normal;
            pair.reach_m = reach(plane.obstacle, distance(pair, stencil_at(pair.nodes, rest_)));
            pair.area_m2 = robot_.areas.points[i];
            if (distance(pair, stencil_at(pair.nodes, x)) < pair.reach_m) pairs.push_back(pair);
        }
    }
}

double Contact::largest_step(std::span<const double> x, std::span<const double> dx) const {
    const double free = largest_plane_step(x, dx);
    if (is_clear(x, dx)) return free;
    const double margin = kept_share * settings_.distance_m;
    const auto limit = [&](const Search::Candidate& c, double& step) {
        if (!c.comes_near(x, dx, margin)) return;
        const double t =
            contact::largest_step(c.features(), stencil_at(c.nodes, x), stencil_at(c.nodes, dx), kept_share, step);
        if (t < step && !belonging_.together(c.first_nodes(), c.second_nodes(), std::sqrt(c.squared_distance(rest_))))
            step = t;
    };
    const auto known = nearby(x, dx);
    const std::vector<double> steps =
        known ? known->run(free, limit)
              : Search(*this, x, dx, margin, Search::What::pairs, settings_.self).run(free, limit);
    return std::accumulate(steps.begin(), steps.end(), free, [](double a, double b) { return std::min(a, b); });
}

double Contact::largest_plane_step(std::span<const double> x, std::span<const double> dx) const {
    double step = 1;
    for (const Plane& plane : planes_) {
        for (const int point : robot_.surface.points) {
            const double now = dot(plane.normal, node_at(x, point) - node_at(x, plane.node));
            const double closing = dot(plane.normal, node_at(dx, plane.node) - node_at(dx, point));
            if (now - closing < kept_share * now)
                step = std::min(step, (1 - kept_share) * std::max(now, 0.0) / closing);
        }
    }
    return step;
}

std::optional<Crossing> Contact::first_crossing(std::span<const double> x, bool self, bool at_rest) const {
    using Found = std::optional<Crossing>;
    const Search search(*this, x, {}, 0, Search::What::crossings, self);
    const auto test = [&](const Search::Candidate& c, Found& found) {
        const auto& n = c.nodes;
        const bool joined =
            std::find(n.begin() + 2, n.end(), n[0]) != n.end() || std::find(n.begin() + 2, n.end(), n[1]) != n.end();
        if (found || joined) return;
        const Vec3 a = node_at(x, n[0]), b = node_at(x, n[1]);
        const Vec3 t0 = node_at(x, n[2]), t1 = node_at(x, n[3]), t2 = node_at(x, n[4]);
        const Rim rim = at_rest ? Rim::left_out : Rim::counts;
        if (!segment_crosses_triangle(a, b, t0, t1, t2, rim) || (!at_rest && edge_and_triangle_belong_together(n)))
            return;
        const int obstacle = std::max(obstacle_of_node_[n[0]], obstacle_of_node_[n[2]]);
        found = {{n[0], n[1]}, {n[2], n[3], n[4]}, obstacle, point_in_plane(a, b, t0, t1, t2)};
    };
    for (const Found& piece : search.run(Found{}, test))
        if (piece) return piece;
    return {};
}

bool Contact::edge_and_triangle_belong_together(std::span<const int, 5> n) const {
    const std::span<const int> edge = n.first<2>(), triangle = n.last<3>();
    const auto r = [&](std::size_t k) { return node_at(rest_, n[k]); };
    if (segment_crosses_triangle(r(0), r(1), r(2), r(3), r(4))) return true;
    double squared = std::numeric_limits<double>::infinity();
    const auto offer = [&](Features features, const Stencil& at) {
        squared = std::min(squared, squared_distance(nearest(features, at), at));
    };
    for (std::size_t k = 0; k < 2; ++k) offer(Features::point_triangle, {r(k), r(2), r(3), r(4)});
    for (std::size_t k = 0; k < 3; ++k) offer(Features::edge_edge, {r(0), r(1), r(2 + k), r(2 + (k + 1) % 3)});
    return belonging_.together(edge, triangle, std::sqrt(squared));
}

std::optional<Crossing> Contact::crossing(std::span<const double> x) const {
    return first_crossing(x, true, false);
}

std::optional<Crossing> Contact::crossing_at_rest() const {
    const auto found = first_crossing(rest_, true, true);
    return found && found->obstacle < 0 ? found : std::nullopt;
}

std::optional<int> Contact::obstacle_touched_at_rest() const {
    int touched = -1;
    for (const Plane& plane : planes_)
        for (const int point : robot_.surface.points)
            if (dot(plane.normal, node_at(rest_, point) - node_at(rest_, plane.node)) <= touching_m_)
                touched = plane.obstacle;
    const Search search(*this, rest_, {}, touching_m_, Search::What::pairs, false);
    const auto test = [&](const Search::Candidate& c, int& found) {
        if (std::sqrt(c.squared_distance(rest_)) <= touching_m_) found = obstacle_of(c.nodes);
    };
    for (const int piece : search.run(-1, test)) touched = std::max(touched, piece);
    if (const auto crossed = first_crossing(rest_, false, true)) touched = crossed->obstacle;
    return touched < 0 ? std::nullopt : std::optional<int>(touched);
}

}  // namespace pliant::sim::contact
