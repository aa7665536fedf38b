// The order of vats with the least total cost of changes, if every pair of vats has its own cost: travel of the store,
// cleaning time, harm of mixing the two resins.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "printing/plan/order.hpp"

namespace pliant::plan {

/// Costs in any one unit (the planner uses seconds), non-negative. Vats are numbered from 0 to vats - 1.
struct ChangeCosts {
    explicit ChangeCosts(int vat_count);

    int vats = 0;
    std::vector<double> swap;   ///< (vats, vats): from the row's vat to the column's; the diagonal counts as 0
    std::vector<double> load;   ///< of loading the first vat
    std::vector<double> store;  ///< of storing the last vat

    [[nodiscard]] std::size_t at(int from, int to) const {
        return static_cast<std::size_t>(from) * static_cast<std::size_t>(vats) + static_cast<std::size_t>(to);
    }
    [[nodiscard]] double between(int from, int to) const { return from == to ? 0 : swap[at(from, to)]; }
};

/// Total of loading, swaps and storing in that order. 0 if nothing is printed.
[[nodiscard]] double change_cost(std::span<const VatList> order, const ChangeCosts& costs);

struct LeastCost {
    std::vector<VatList> order;
    double cost = 0;
    bool exact = true;  ///< false: some layer has more than twelve vats of unequal costs, and the order within it is
                        ///< heuristic
};

/// Least cost over all orders of all layers. Dynamic programming over the last vat of each layer; within a layer the
/// cheapest path from its first vat to its last through all others (Held and Karp), computed once for each set of vats.
/// Time: linear in the layers; per set of k vats 2^k k^3.
[[nodiscard]] LeastCost least_cost_order(std::span<const VatList> layers, const ChangeCosts& costs);

}  // namespace pliant::plan
