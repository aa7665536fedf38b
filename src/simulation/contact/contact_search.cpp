// Queries over all features that are near each other: pairs, step lengths, crossings.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>
#include <utility>

#include "base/core/parallel.hpp"
#include "simulation/contact/clearance.hpp"
#include "simulation/contact/contact.hpp"
#include "simulation/contact/intersection.hpp"

namespace pliant::sim::contact {

namespace {

/// A tenth: share of its present distance that every pair keeps in a step.
constexpr double kept_share = 0.1;

/// After this many calls at nearby states it pays to cache what is near.
constexpr int settled_calls = 2;

/// Motion of a node, in units of the distance at which forces act, after which the search is repeated.
constexpr double slack_share = 0.5;

Stencil stencil_at(std::span<const int> nodes, std::span<const double> x) {
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
    BoxTree::MovingFit fit;  ///< without an end where nothing moves
};

}  // namespace

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
        std::array<int, 5> nodes{};  ///< 4 for the first two kinds
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

    enum class Shape { points, edges, triangles };

    template <class Nodes>
    [[nodiscard]] Group fitted(const BoxTree& tree, const std::vector<Nodes>& features) const {
        const std::vector<Bounds> start = boxes_of(features, x_, {}, margin_ / 2);
        if (dx_.empty()) return {&tree, {tree.fit(start), {}, {}}};
        return {&tree, tree.fit(start, boxes_of(features, x_, dx_, margin_ / 2), moving_ones(features, dx_))};
    }

    /// The group, built on first use.
    const Group& group(Shape shape, std::size_t k) {
        const auto [entry, fresh] = groups_.try_emplace({shape, k});
        if (!fresh) return entry->second;
        const Side& side = contact_.side(k);
        entry->second = shape == Shape::points  ? fitted(side.points, side.surface.points)
                        : shape == Shape::edges ? fitted(side.edges, side.surface.edges)
                                                : fitted(side.triangles, side.surface.triangles);
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

    const Contact& contact_;
    std::span<const double> x_, dx_;
    double margin_;
    std::map<std::pair<Shape, std::size_t>, Group> groups_;
    std::map<std::size_t, Bounds> boxes_;
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
    std::vector<double> x_;
    double slack_m_;
    std::vector<Search::Candidate> candidates_;
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

namespace {

/// A clearance that answers fewer calls than this has cost more than it saved.
constexpr int worth_knowing = 4;

}  // namespace

Contact::Contact() : memory_(std::make_shared<Memory>()) {}

/// A state far from the last one is usually left at once, and a step that ends in one iteration asks twice at its
/// start; caching pays from the third nearby call on.
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
        if (now < seen_m_ && !left_out(c.first_nodes(), c.second_nodes(), rest)) seen.push_back({c, now, rest});
    };
    const Search search(*this, x, {}, seen_m_, Search::What::pairs, settings_.self);
    std::vector<Seen> all;
    for (const std::vector<Seen>& piece : search.run(std::vector<Seen>{}, look))
        all.insert(all.end(), piece.begin(), piece.end());
    const auto reach_of = [&](const Seen& s) { return reach(obstacle_of(s.candidate.nodes), s.rest_m); };
    if (std::ranges::any_of(all, [&](const Seen& s) { return s.now_m <= reach_of(s); })) return wait_for_clearance();
    std::vector<Clearance::Side> sides;
    for (std::size_t k = 0; k < 2 + parts_.size(); ++k) sides.push_back({&side(k).surface, side(k).regions});
    const auto meetings = this->meetings(settings_.self);
    Clearance clearance(sides, meetings, x, seen_m_, settings_.distance_m);
    for (const Seen& seen : all) {
        const auto first = seen.candidate.first_nodes(), second = seen.candidate.second_nodes();
        const std::pair both(side_of(first[0]), side_of(second[0]));
        const auto is_it = [&](const auto& m) { return m == both || m == std::pair(both.second, both.first); };
        const auto meeting = std::ranges::find_if(meetings, is_it);
        const bool in_order = *meeting == both;
        clearance.offer(static_cast<std::size_t>(meeting - meetings.begin()), in_order ? first : second,
                        in_order ? second : first, seen.now_m, reach_of(seen));
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
    find_planes(x, 0, pairs);
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
        if (squared < reach * reach && !left_out(c.first_nodes(), c.second_nodes(), apart))
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

Pairs Contact::find_near(std::span<const double> x, double within_m) const {
    const auto consider = [&](const Search::Candidate& c, Pairs& found) {
        if (!(c.squared_distance(x) < within_m * within_m)) return;
        const double apart = std::sqrt(c.squared_distance(rest_));
        if (left_out(c.first_nodes(), c.second_nodes(), apart)) return;
        const double reach = this->reach(obstacle_of(c.nodes), apart);
        found.push_back(make_pair(c.features() == Features::edge_edge, c.nodes, reach, c.area_m2));
    };
    const Search search(*this, x, {}, within_m, Search::What::pairs, settings_.self);
    Pairs pairs;
    for (const Pairs& piece : search.run(Pairs{}, consider)) pairs.insert(pairs.end(), piece.begin(), piece.end());
    find_planes(x, within_m, pairs);
    return pairs;
}

std::vector<std::array<int, 2>> Contact::partners(const Pairs& pairs) const {
    std::vector<std::array<int, 2>> all;
    for (const Pair& pair : pairs) {
        const auto owner = [&](int node) {
            return obstacle_of_node_[node] >= 0 ? -obstacle_of_node_[node] - 1 : part_of(node);
        };
        const auto [low, high] = std::minmax(owner(pair.nodes.front()), owner(pair.nodes.back()));
        all.push_back({low, high});
    }
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

int Contact::obstacle_of(std::span<const int> nodes) const {
    return std::max(obstacle_of_node_[nodes[0]], obstacle_of_node_[nodes[3]]);
}

double Contact::reach(int obstacle, double apart_m) const {
    return std::min(settings_.distance_m, obstacle < 0 || drawn_in_m_[obstacle] == 0 ? 0.5 * apart_m : apart_m);
}

bool Contact::left_out(std::span<const int> first, std::span<const int> second, double apart_m) const {
    return belonging_.together(first, second, apart_m) || are_joined(first, second);
}

bool Contact::are_joined(std::span<const int> first, std::span<const int> second) const {
    if (joined_.empty() || obstacle_of_node_[first[0]] >= 0 || obstacle_of_node_[second[0]] >= 0) return false;
    const int a = part_of(first[0]) - 1, b = part_of(second[0]) - 1;
    return std::ranges::any_of(joined_, [&](const Joined& j) {
        if (std::minmax(j.first, j.second) != std::minmax(a, b)) return false;
        const auto is_near = [&](int node) { return norm(node_at(rest_, node) - j.center) <= j.radius_m; };
        return std::ranges::any_of(first, is_near) && std::ranges::any_of(second, is_near);
    });
}

Pair Contact::make_pair(bool edges, std::span<const int> nodes, double reach_m, double area_m2) const {
    Pair pair;
    pair.kind = edges ? PairKind::edge_edge : PairKind::point_triangle;
    std::copy_n(nodes.begin(), 4, pair.nodes.begin());
    pair.obstacle = obstacle_of(nodes);
    pair.robot_first = obstacle_of_node_[nodes[0]] < 0;
    pair.reach_m = reach_m;
    // Every part of a surface counts as part of a point and of a triangle, and again as part of an edge.
    pair.area_m2 = area_m2 / 2;
    const Vec3 u = node_at(rest_, nodes[1]) - node_at(rest_, nodes[0]);
    const Vec3 v = node_at(rest_, nodes[3]) - node_at(rest_, nodes[2]);
    pair.parallel_m4 = 1e-3 * dot(u, u) * dot(v, v);
    return pair;
}

std::vector<std::pair<std::size_t, std::size_t>> Contact::meetings(bool self) const {
    std::vector<std::pair<std::size_t, std::size_t>> meetings{{0, 1}};
    for (std::size_t k = 2; k < 2 + parts_.size(); ++k) {
        for (std::size_t other = 0; other < k; ++other) {
            const auto apart = [&](const Joined& j) {
                const std::size_t a = j.first < 0 ? 0 : 2 + static_cast<std::size_t>(j.first);
                const std::size_t b = j.second < 0 ? 0 : 2 + static_cast<std::size_t>(j.second);
                return std::isinf(j.radius_m) && std::minmax(a, b) == std::minmax(other, k);
            };
            if (std::ranges::none_of(joined_, apart)) meetings.emplace_back(other, k);
        }
    }
    if (self) meetings.emplace_back(0, 0);
    return meetings;
}

void Contact::find_planes(std::span<const double> x, double within_m, Pairs& pairs) const {
    visit_moving_sides([&](const Side& side) { find_planes(side, x, within_m, pairs); });
}

void Contact::find_planes(const Side& side, std::span<const double> x, double within_m, Pairs& pairs) const {
    for (const Plane& plane : planes_) {
        for (std::size_t i = 0; i < side.surface.points.size(); ++i) {
            const int point = side.surface.points[i];
            Pair pair;
            pair.kind = PairKind::point_plane;
            pair.nodes = {point, plane.node, plane.node, plane.node};
            pair.obstacle = plane.obstacle;
            pair.normal = plane.normal;
            pair.reach_m = reach(plane.obstacle, distance(pair, stencil_at(pair.nodes, rest_)));
            pair.area_m2 = side.areas.points[i];
            const double within = within_m > 0 ? within_m : pair.reach_m;
            if (distance(pair, stencil_at(pair.nodes, x)) < within) pairs.push_back(pair);
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
        if (t < step && !left_out(c.first_nodes(), c.second_nodes(), std::sqrt(c.squared_distance(rest_)))) step = t;
    };
    const auto known = nearby(x, dx);
    const std::vector<double> steps =
        known ? known->run(free, limit)
              : Search(*this, x, dx, margin, Search::What::pairs, settings_.self).run(free, limit);
    return std::accumulate(steps.begin(), steps.end(), free, [](double a, double b) { return std::min(a, b); });
}

bool Contact::meets(std::span<const double> x, std::span<const double> dx) const {
    if (largest_plane_step(x, dx) < 1) return true;
    if (is_clear(x, dx)) return false;
    // Distances at the start answer for this step as well as for later ones; the search along the step is slower.
    note_clearance(x);
    return !is_clear(x, dx) && largest_step(x, dx) < 1;
}

double Contact::largest_plane_step(std::span<const double> x, std::span<const double> dx) const {
    double step = 1;
    visit_moving_sides([&](const Side& side) { shorten_to_planes(side, x, dx, step); });
    return step;
}

void Contact::shorten_to_planes(const Side& side, std::span<const double> x, std::span<const double> dx,
                                double& step) const {
    for (const Plane& plane : planes_) {
        for (const int point : side.surface.points) {
            const double now = dot(plane.normal, node_at(x, point) - node_at(x, plane.node));
            const double closing = dot(plane.normal, node_at(dx, plane.node) - node_at(dx, point));
            if (now - closing < kept_share * now)
                step = std::min(step, (1 - kept_share) * std::max(now, 0.0) / closing);
        }
    }
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
        if (!segment_crosses_triangle(a, b, t0, t1, t2, rim) || (!at_rest && edge_and_triangle_belong_together(n)) ||
            are_joined(std::span(n).first(2), std::span(n).last(3)))
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
    return left_out(edge, triangle, std::sqrt(squared));
}

std::optional<Crossing> Contact::crossing(std::span<const double> x) const {
    return first_crossing(x, true, false);
}

std::optional<Crossing> Contact::crossing_at_rest() const {
    const auto found = first_crossing(rest_, true, true);
    return found && found->obstacle < 0 ? found : std::nullopt;
}

std::optional<Contact::Touched> Contact::obstacle_touched_at_rest() const {
    std::optional<Touched> touched;
    visit_moving_sides([&](const Side& side) {
        for (const Plane& plane : planes_)
            for (const int point : side.surface.points)
                if (dot(plane.normal, node_at(rest_, point) - node_at(rest_, plane.node)) < -touching_m_)
                    touched = {plane.obstacle, part_of(point)};
    });
    const Search search(*this, rest_, {}, touching_m_, Search::What::pairs, false);
    const auto moving = [&](int a, int b) { return part_of(obstacle_of_node_[a] < 0 ? a : b); };
    const auto test = [&](const Search::Candidate& c, std::optional<Touched>& found) {
        const int obstacle = obstacle_of(c.nodes);
        if (obstacle >= 0 && std::sqrt(c.squared_distance(rest_)) <= touching_m_)
            found = {obstacle, moving(c.nodes[0], c.nodes[3])};
    };
    for (const auto& piece : search.run(std::optional<Touched>(), test)) touched = piece ? piece : touched;
    const auto crossed = first_crossing(rest_, false, true);
    if (crossed && crossed->obstacle >= 0)
        touched = {crossed->obstacle, moving(crossed->edge[0], crossed->triangle[0])};
    return touched;
}

std::string Contact::part_name(int part) const {
    return part == 0 ? "the robot" : "object \"" + rigid_[static_cast<std::size_t>(part) - 1].name + "\"";
}

Status Contact::check_parts_at_rest() const {
    const auto refused = [&](int a, int b) {
        return input_error("{} touches or crosses {} at rest: leave a gap", part_name(std::max(part_of(a), part_of(b))),
                           part_name(std::min(part_of(a), part_of(b))));
    };
    using Found = std::optional<std::array<int, 2>>;
    const Search search(*this, rest_, {}, touching_m_, Search::What::pairs, false);
    const auto test = [&](const Search::Candidate& c, Found& found) {
        if (part_of(c.nodes[0]) != part_of(c.nodes[3]) && obstacle_of(c.nodes) < 0 &&
            std::sqrt(c.squared_distance(rest_)) <= touching_m_ && !are_joined(c.first_nodes(), c.second_nodes()))
            found = {c.nodes[0], c.nodes[3]};
    };
    for (const Found& piece : search.run(Found{}, test))
        if (piece) return refused((*piece)[0], (*piece)[1]);
    const auto crossed = first_crossing(rest_, false, true);
    if (crossed && crossed->obstacle < 0 && part_of(crossed->edge[0]) != part_of(crossed->triangle[0]))
        return refused(crossed->edge[0], crossed->triangle[0]);
    return {};
}

}  // namespace pliant::sim::contact
