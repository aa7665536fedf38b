// Which features are near each other: pairs on which forces act.
#include "simulation/contact/contact_search.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "base/core/disjoint_sets.hpp"

namespace pliant::sim::contact {
namespace {

/// After this many calls at nearby states it pays to cache what is near.
constexpr int settled_calls = 2;

template <class Value>
std::vector<Value> each_once(std::vector<Value> values) {
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

std::array<int, 2> sorted(int a, int b) {
    return {std::min(a, b), std::max(a, b)};
}

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

Pairs Contact::find(std::span<const double> x) const {
    {
        const std::lock_guard lock(memory_->mutex);
        if (std::ranges::equal(memory_->found.x, x)) return memory_->found.pairs;
    }
    const bool clear = is_clear(x, {});
    Pairs pairs = clear ? Pairs{} : search_pairs(x);
    if (!clear && pairs.empty()) note_clearance(x);
    find_exact(x, 0, pairs);
    const std::lock_guard lock(memory_->mutex);
    memory_->found.x.assign(x.begin(), x.end());
    memory_->found.pairs = pairs;
    return pairs;
}

double Contact::rest_distance(int point, std::int64_t flat_face) const {
    const std::lock_guard lock(memory_->mutex);
    const auto [known, is_new] = memory_->from_face_m.try_emplace({flat_face, point}, 0);
    if (!is_new) return known->second;
    double least = std::numeric_limits<double>::infinity();
    for (const std::array<int, 3>& t : flat_faces_.at(flat_face)) {
        const Stencil at = stencil_at(std::array{point, t[0], t[1], t[2]}, rest_);
        least = std::min(least, squared_distance(nearest(Features::point_triangle, at), at));
    }
    return known->second = std::sqrt(least);
}

Pairs Contact::once_per_face(Pairs pairs, std::span<const double> x, bool within_reach) const {
    struct Closest {
        std::size_t pair;
        double distance_m;
    };
    std::map<std::pair<std::int64_t, int>, Closest> closest;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        if (pairs[k].flat_face < 0) continue;
        const double apart = distance(pairs[k], stencil_at(pairs[k].nodes, x));
        const auto [at, is_new] = closest.try_emplace({pairs[k].flat_face, pairs[k].nodes[0]}, Closest{k, apart});
        if (!is_new && apart < at->second.distance_m) at->second = {k, apart};
    }
    if (closest.empty()) return pairs;
    Pairs kept;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        Pair& pair = pairs[k];
        if (pair.flat_face >= 0) {
            const Closest& one = closest.at({pair.flat_face, pair.nodes[0]});
            if (one.pair != k) continue;
            const double apart_m = rest_distance(pair.nodes[0], pair.flat_face) - pair.radius_m;
            const std::span nodes(pair.nodes);
            pair.reach_m = reach(pair.nodes, apart_m);
            if (left_out(nodes.first(1), nodes.subspan(1), apart_m)) continue;
            if (within_reach && !(one.distance_m < pair.reach_m)) continue;
        }
        kept.push_back(pair);
    }
    return kept;
}

Pairs Contact::search_pairs(std::span<const double> x) const {
    const double most = settings_.distance_m;
    const auto consider = [&](const Search::Candidate& c, Pairs& found) {
        if (c.distance_bound(x) >= most) return;
        const double squared = c.squared_distance(x);
        if (squared >= most * most) return;
        const double apart = c.flat_face < 0 ? std::sqrt(c.squared_distance(rest_)) : 0;
        const double reach = c.flat_face < 0 ? this->reach(std::span(c.nodes).first<4>(), apart) : most;
        if (c.flat_face >= 0 || (squared < reach * reach && !left_out(c.first_nodes(), c.second_nodes(), apart)))
            found.push_back(make_pair(c.features() == Features::edge_edge, c.nodes, reach, c.area_m2, c.flat_face));
    };
    const auto known = nearby(x, {});
    const std::vector<Pairs> pieces =
        known ? known->run(Pairs{}, consider)
              : Search(*this, x, {}, most, Search::What::pairs, settings_.self).run(Pairs{}, consider);
    Pairs pairs;
    for (const Pairs& piece : pieces) pairs.insert(pairs.end(), piece.begin(), piece.end());
    return once_per_face(std::move(pairs), x, true);
}

Pairs Contact::find_near(std::span<const double> x, double within_m) const {
    const auto consider = [&](const Search::Candidate& c, Pairs& found) {
        if (!(c.squared_distance(x) < within_m * within_m)) return;
        const double apart = c.flat_face < 0 ? std::sqrt(c.squared_distance(rest_)) : 0;
        if (c.flat_face < 0 && left_out(c.first_nodes(), c.second_nodes(), apart)) return;
        const double reach = this->reach(std::span(c.nodes).first<4>(), apart);
        found.push_back(make_pair(c.features() == Features::edge_edge, c.nodes, reach, c.area_m2, c.flat_face));
    };
    const Search search(*this, x, {}, within_m, Search::What::pairs, settings_.self);
    Pairs pairs;
    for (const Pairs& piece : search.run(Pairs{}, consider)) pairs.insert(pairs.end(), piece.begin(), piece.end());
    pairs = once_per_face(std::move(pairs), x, false);
    find_exact(x, within_m, pairs);
    return pairs;
}

std::array<int, 2> Contact::owners(const Pair& pair) const {
    const auto owner = [&](int node) {
        return obstacle_of_node_[node] >= 0 ? -obstacle_of_node_[node] - 1 : part_of(node);
    };
    const auto [low, high] = std::minmax({owner(pair.nodes.front()), owner(pair.nodes.back())});
    return {low, high};
}

std::vector<std::array<int, 2>> Contact::partners(const Pairs& pairs) const {
    std::vector<std::array<int, 2>> all;
    for (const Pair& pair : pairs) all.push_back(owners(pair));
    return each_once(std::move(all));
}

std::vector<std::array<std::int64_t, 3>> Contact::faces_met(const Pairs& pairs) const {
    std::vector<std::array<std::int64_t, 3>> all;
    for (const Pair& pair : pairs) {
        const auto [low, high] = owners(pair);
        if (pair.flat_face >= 0 && obstacle_of_node_[pair.nodes.back()] >= 0 && high > 0)
            all.push_back({low, high, pair.flat_face});
    }
    return each_once(std::move(all));
}

int Contact::obstacle_of(std::span<const int> nodes) const {
    return std::max(obstacle_of_node_[nodes[0]], obstacle_of_node_[nodes[3]]);
}

/// A pair of two pieces does not keep its own distance at rest, since they may slide: the surroundings of what was
/// near, with a longer reach, would be the rim of a pit in which it is caught. Much smaller gaps, as between bodies
/// that are drawn flush, are local: barriers as short as these everywhere would make all contact slow.
double Contact::reach(std::span<const int, 4> nodes, double apart_m) const {
    const int obstacle = obstacle_of(nodes);
    if (obstacle >= 0 && drawn_in_m_[obstacle] > 0) return std::min(settings_.distance_m, apart_m);
    constexpr double shortest = 1.0 / 8;  // of the distance
    const auto known = gap_m_.find(sorted(piece_of(nodes[0]), piece_of(nodes[3])));
    const double gap = known == gap_m_.end() ? apart_m : std::max(known->second, shortest * settings_.distance_m);
    return std::min(settings_.distance_m, 0.5 * std::min(gap, apart_m));
}

void Contact::number_pieces(const Surface& robot) {
    DisjointSets pieces(static_cast<std::size_t>(robot_nodes_));
    for (const auto& [a, b, c] : robot.triangles) {
        pieces.join(a, b);
        pieces.join(b, c);
    }
    piece_of_node_.resize(static_cast<std::size_t>(node_count()));
    for (int node = 0; node < node_count(); ++node)
        piece_of_node_[node] = node < robot_nodes_ ? pieces.find(node) : robot_nodes_ + obstacle_of_node_[node];
}

void Contact::measure_gaps() {
    const bool only_drawn_in = std::ranges::none_of(drawn_in_m_, [](double depth) { return depth == 0; });
    const auto is_first = [&](int node) { return piece_of(node) == piece_of(robot_.surface.points.front()); };
    if (only_drawn_in && rigid_.empty() && std::ranges::all_of(robot_.surface.points, is_first)) return;
    const double near = 2 * settings_.distance_m;
    using Gaps = std::map<std::array<int, 2>, double>;
    const auto look = [&](const Search::Candidate& c, Gaps& found) {
        const std::array<int, 2> both = sorted(piece_of(c.nodes[0]), piece_of(c.nodes[3]));
        if (both[0] == both[1] || c.distance_bound(rest_) >= near) return;
        const double apart = std::sqrt(c.squared_distance(rest_));
        if (apart >= near || left_out(c.first_nodes(), c.second_nodes(), apart)) return;
        const auto [gap, is_new] = found.try_emplace(both, apart);
        if (!is_new) gap->second = std::min(gap->second, apart);
    };
    const Search search(*this, rest_, {}, near, Search::What::pairs, settings_.self);
    for (const Gaps& piece : search.run(Gaps{}, look)) {
        for (const auto& [both, apart] : piece) {
            const auto [gap, is_new] = gap_m_.try_emplace(both, apart);
            if (!is_new) gap->second = std::min(gap->second, apart);
        }
    }
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

Pair Contact::make_pair(bool edges, std::span<const int> nodes, double reach_m, double area_m2,
                        std::int64_t flat_face) const {
    Pair pair;
    pair.flat_face = flat_face;
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

}  // namespace pliant::sim::contact
