// The order in which the vats of each layer are used, and the least possible number of swaps.
//
// A layer is the list of distinct vats that print something on it, in the order of the job's materials; layers where
// nothing is printed are empty lists and cost nothing. Loading the first vat before the print is not a swap; every
// later change of vat is one.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace pliant::plan {

using VatList = std::vector<int>;

enum class OrderRule {
    naive,         ///< as listed, on every layer
    thesis,        ///< a layer begins with the vat that the previous one ended with, if it uses that; the rest as
                   ///< listed
    fewest_swaps,  ///< an order with the least possible number of swaps
    least_cost,    ///< an order with the least time for vat changes; needs their costs, see least_cost.hpp
};

/// "naive", "thesis", "fewest-swaps", "least-cost".
[[nodiscard]] std::string_view rule_name(OrderRule rule);

/// The vats of every layer in printing order, by any rule except least_cost.
[[nodiscard]] std::vector<VatList> order_vats(std::span<const VatList> layers, OrderRule rule = OrderRule::thesis);

/// Number of swaps in that order.
[[nodiscard]] int count_swaps(std::span<const VatList> order);

/// The least number of swaps over all orders; exact. A layer of k vats costs k - 1, plus one unless it begins with the
/// previous layer's last vat; the possible last vats are tracked through all layers (dynamic programming, linear in the
/// number of vat uses).
[[nodiscard]] int fewest_swaps(std::span<const VatList> layers);

}  // namespace pliant::plan
