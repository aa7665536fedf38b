// The order of vats whose changes cost least, where every pair of vats has a cost of its own: how far the store goes,
// how long the part is cleaned, what a mixture of the two resins would harm.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "printing/plan/order.hpp"

namespace pliant::plan {

/// Costs in any one unit (the planner: seconds), none negative. Vats are numbered from 0 to vats - 1.
struct ChangeCosts {
    explicit ChangeCosts(int vat_count);

    int vats = 0;
    std::vector<double> swap;   ///< (vats, vats): from the row's vat to the column's; the diagonal counts as 0
    std::vector<double> load;   ///< of the first vat
    std::vector<double> store;  ///< of the last vat

    [[nodiscard]] std::size_t at(int from, int to) const {
        return static_cast<std::size_t>(from) * static_cast<std::size_t>(vats) + static_cast<std::size_t>(to);
    }
    [[nodiscard]] double between(int from, int to) const { return from == to ? 0 : swap[at(from, to)]; }
};

/// All changes of that order: loading, swaps, storing. 0 if nothing is printed.
[[nodiscard]] double change_cost(std::span<const VatList> order, const ChangeCosts& costs);

struct LeastCost {
    std::vector<VatList> order;
    double cost = 0;
    bool exact = true;  ///< false: some layer has more than twelve vats of uneven costs, and its inner order is a guess
};

/// Least cost over all orders of all layers. Dynamic programming over the vat that is left in the machine; within a
/// layer the cheapest path from its first vat to its last through all others (Held and Karp), found once for each set
/// of vats. Time linear in the layers; per set of k vats 2^k k^3.
[[nodiscard]] LeastCost least_cost_order(std::span<const VatList> layers, const ChangeCosts& costs);

}  // namespace pliant::plan
