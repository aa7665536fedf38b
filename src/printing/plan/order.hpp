// In which order the vats of each layer are used, and how few swaps there could be.
//
// A layer is the list of distinct vats that print something on it, in the order of the job's materials; layers where
// nothing is printed are empty lists and cost nothing. The first vat is loaded before the print and is no swap; from
// then on every change of vat is one.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace pliant::plan {

using VatList = std::vector<int>;

enum class OrderRule {
    naive,         ///< as listed, on every layer
    thesis,        ///< the vat used last on a layer, if the next one needs it, goes first there; the rest as listed
    fewest_swaps,  ///< an order that reaches the least number of swaps there is
    least_cost,    ///< the changes of vat take least time; needs their costs, see least_cost.hpp
};

/// "naive", "thesis", "fewest-swaps", "least-cost".
[[nodiscard]] std::string_view rule_name(OrderRule rule);

/// The vats of every layer in the order of printing; by any rule but least_cost.
[[nodiscard]] std::vector<VatList> order_vats(std::span<const VatList> layers, OrderRule rule = OrderRule::thesis);

/// Changes of vat in that order.
[[nodiscard]] int count_swaps(std::span<const VatList> order);

/// The least number of swaps over all orders; exact. A layer of k vats costs k - 1, and one more unless it begins with
/// the vat that the layer before ended with; which vat can be last is followed through all layers (dynamic programming,
/// time linear in the number of vat uses).
[[nodiscard]] int fewest_swaps(std::span<const VatList> layers);

}  // namespace pliant::plan
