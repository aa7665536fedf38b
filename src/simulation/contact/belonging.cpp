#include "simulation/contact/belonging.hpp"

#include <algorithm>

namespace pliant::sim::contact {

namespace {

// Relative to the longest edge there. A notch with an opening angle of 2 degrees is 0.035 wide one edge from its tip,
// so its flanks count as two surfaces. No realistic mesh has gaps of 1/10,000 of its edges.
constexpr double joined_share = 0.02;
constexpr double any_share = 1e-4;

}  // namespace

Belonging::Belonging(const Surface& surface, std::span<const double> positions, double touching_m)
    : touching_m_(touching_m), first_neighbour_(positions.size() / 3 + 1), longest_m_(positions.size() / 3) {
    for (const int node : surface.points) ++first_neighbour_[node + 1];
    for (const auto& e : surface.edges)
        for (const int node : e) ++first_neighbour_[node + 1];
    for (std::size_t n = 1; n < first_neighbour_.size(); ++n) first_neighbour_[n] += first_neighbour_[n - 1];
    neighbours_.resize(first_neighbour_.back());
    std::vector<std::size_t> next(first_neighbour_.begin(), first_neighbour_.end() - 1);
    for (const int node : surface.points) neighbours_[next[node]++] = node;
    for (const auto& e : surface.edges) {
        const double length = norm(node_at(positions, e[0]) - node_at(positions, e[1]));
        for (std::size_t k = 0; k < 2; ++k) {
            neighbours_[next[e[k]]++] = e[1 - k];
            longest_m_[e[k]] = std::max(longest_m_[e[k]], length);
        }
    }
    for (std::size_t n = 0; n + 1 < first_neighbour_.size(); ++n)
        std::sort(neighbours_.begin() + static_cast<std::ptrdiff_t>(first_neighbour_[n]),
                  neighbours_.begin() + static_cast<std::ptrdiff_t>(first_neighbour_[n + 1]));
}

std::span<const int> Belonging::neighbours(int node) const {
    return {neighbours_.data() + first_neighbour_[node], first_neighbour_[node + 1] - first_neighbour_[node]};
}

/// True if joined by at most two edges: each node lists itself, so that one edge, or none, is found too.
bool Belonging::are_joined(int a, int b) const {
    const std::span<const int> of_a = neighbours(a), of_b = neighbours(b);
    auto i = of_a.begin();
    for (auto j = of_b.begin(); i != of_a.end() && j != of_b.end();) {
        if (*i == *j) return true;
        *i < *j ? ++i : ++j;
    }
    return false;
}

bool Belonging::together(std::span<const int> first, std::span<const int> second, double apart_m) const {
    if (apart_m <= touching_m_) return true;
    double scale_m = 0;
    for (const std::span<const int> feature : {first, second})
        for (const int node : feature) {
            if (static_cast<std::size_t>(node) >= longest_m_.size()) return false;
            scale_m = std::max(scale_m, longest_m_[node]);
        }
    if (apart_m <= any_share * scale_m) return true;
    if (apart_m > joined_share * scale_m) return false;
    return std::any_of(first.begin(), first.end(), [&](int a) {
        return std::any_of(second.begin(), second.end(), [&](int b) { return are_joined(a, b); });
    });
}

}  // namespace pliant::sim::contact
