#include "base/linalg/separator.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace pliant::linalg {
namespace {

constexpr int most_rounds = 20;  // each makes the separator smaller; more than six are rarely needed

/// Matches nodes of the separator, as many as possible, with distinct neighbours on one side.
class Matching {
public:
    Matching(const Graph& graph, const std::vector<Side>& sides, Side side, const std::vector<int>& separator)
        : graph_(graph), sides_(sides), side_(side), partner_(sides.size(), -1), dead_(sides.size(), 0) {
        for (const int s : separator) take_a_free_one(s);
        for (const int s : separator) {
            if (partner_[s] < 0) find_path(s);
        }
    }

    /// -1: none.
    [[nodiscard]] int partner(int node) const { return partner_[node]; }

private:
    struct Step {
        int node, next;  ///< node of the separator, and the index of its next neighbour to try
    };

    void take_a_free_one(int s) {
        for (int k = graph_.start[s]; k < graph_.start[s + 1]; ++k) {
            const int other = graph_.other[k];
            if (sides_[other] == side_ && partner_[other] < 0) return pair(s, other);
        }
    }

    /// An alternating path that ends at a free node, which gives s a partner. Nodes visited by a failed search need not
    /// be visited by later ones.
    void find_path(int s) {
        seen_.clear();
        path_.assign(1, {s, graph_.start[s]});
        while (!path_.empty()) {
            auto& [node, next] = path_.back();
            if (next == graph_.start[node + 1]) {
                path_.pop_back();
                continue;
            }
            const int other = graph_.other[next++];
            if (sides_[other] != side_ || std::exchange(dead_[other], 1)) continue;
            seen_.push_back(other);
            if (partner_[other] < 0) {
                for (const int w : seen_) dead_[w] = 0;
                return exchange_along_path(other);
            }
            path_.push_back({partner_[other], graph_.start[partner_[other]]});
        }
    }

    void exchange_along_path(int free) {
        for (auto step = path_.rbegin(); step != path_.rend(); ++step) {
            const int before = partner_[step->node];
            pair(step->node, free);
            free = before;
        }
    }

    void pair(int s, int other) {
        partner_[s] = other;
        partner_[other] = s;
    }

    const Graph& graph_;
    const std::vector<Side>& sides_;
    Side side_;
    std::vector<int> partner_;
    std::vector<char> dead_;
    std::vector<int> seen_;
    std::vector<Step> path_;
};

/// Nodes of the separator and of one side, to be exchanged.
struct Exchange {
    std::vector<int> leaving, coming;
};

/// The nodes of the separator whose number most exceeds that of their neighbours on `side` (Dulmage and Mendelsohn
/// 1958): those reachable by an alternating path from one without a partner.
Exchange best_exchange(const Graph& graph, const std::vector<Side>& sides, Side side) {
    std::vector<int> separator;
    for (int i = 0; i < graph.nodes(); ++i) {
        if (sides[i] == Side::separator) separator.push_back(i);
    }
    const Matching matching(graph, sides, side, separator);
    Exchange result;
    for (const int s : separator) {
        if (matching.partner(s) < 0) result.leaving.push_back(s);
    }
    std::vector<char> seen(sides.size(), 0);
    for (std::size_t k = 0; k < result.leaving.size(); ++k) {
        const int s = result.leaving[k];
        for (int e = graph.start[s]; e < graph.start[s + 1]; ++e) {
            const int other = graph.other[e];
            if (sides[other] != side || std::exchange(seen[other], 1)) continue;
            result.coming.push_back(other);
            result.leaving.push_back(matching.partner(other));
        }
    }
    return result;
}

}  // namespace

void shrink_separator(const Graph& graph, std::vector<Side>& sides, int least) {
    std::array<int, 2> count{};
    for (const Side side : sides) {
        if (side != Side::separator) ++count[static_cast<std::size_t>(side)];
    }
    int failures = 0;
    for (int round = 0; round < most_rounds && failures < 2; ++round) {
        const auto from = static_cast<std::size_t>(round % 2);
        const Exchange exchange = best_exchange(graph, sides, Side(from));
        const auto coming = static_cast<int>(exchange.coming.size());
        if (exchange.leaving.empty() || count[from] - coming < least) {
            ++failures;
            continue;
        }
        failures = 0;
        for (const int node : exchange.leaving) sides[node] = Side(1 - from);
        for (const int node : exchange.coming) sides[node] = Side::separator;
        count[from] -= coming;
        count[1 - from] += static_cast<int>(exchange.leaving.size());
    }
}

}  // namespace pliant::linalg
