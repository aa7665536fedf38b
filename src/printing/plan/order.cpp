#include "printing/plan/order.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

namespace pliant::plan {
namespace {

/// The best order of a layer that ends with vat `last`: begins with `first`.
struct Ending {
    int last = 0;
    int swaps = 0;
    int first = 0;
    bool joined = false;  ///< the previous layer ends with `first`: no swap at the boundary
};

/// The two cheapest ways to begin a layer: at least one of them differs from any given last vat.
struct Beginning {
    int vat = -1;
    int swaps = std::numeric_limits<int>::max();
    bool joined = false;
};

Ending best_ending(int last, std::span<const Beginning> beginnings, std::size_t vats) {
    Ending best{last, std::numeric_limits<int>::max(), last, false};
    for (const Beginning& b : beginnings) {
        if (vats > 1 && b.vat == last) continue;
        if (b.swaps < best.swaps) best = {last, b.swaps, b.vat, b.joined};
    }
    best.swaps += static_cast<int>(vats) - 1;
    return best;
}

/// `before` is empty if nothing has been printed yet: any vat may then be loaded first.
std::vector<Ending> endings(const VatList& layer, const std::vector<Ending>& before) {
    std::map<int, int> ended;
    int cheapest = 0;
    if (!before.empty()) {
        cheapest = std::numeric_limits<int>::max();
        for (const Ending& e : before) {
            ended[e.last] = e.swaps;
            cheapest = std::min(cheapest, e.swaps);
        }
    }
    std::vector<Beginning> ways;
    for (const int vat : layer) {
        const auto found = ended.find(vat);
        const bool joined = found != ended.end() && found->second <= cheapest + 1;
        const int change = before.empty() ? 0 : cheapest + 1;
        ways.push_back({vat, joined ? found->second : change, joined});
    }
    std::stable_sort(ways.begin(), ways.end(), [](const auto& a, const auto& b) { return a.swaps < b.swaps; });
    ways.resize(std::min<std::size_t>(ways.size(), 2));
    std::vector<Ending> result;
    for (const int vat : layer) result.push_back(best_ending(vat, ways, layer.size()));
    return result;
}

std::vector<std::vector<Ending>> all_endings(std::span<const VatList> layers) {
    std::vector<std::vector<Ending>> table;
    std::vector<Ending> before;
    for (const VatList& layer : layers) {
        table.push_back(layer.empty() ? std::vector<Ending>{} : endings(layer, before));
        if (!layer.empty()) before = table.back();
    }
    return table;
}

const Ending& cheapest_ending(const std::vector<Ending>& layer) {
    return *std::min_element(layer.begin(), layer.end(),
                             [](const auto& a, const auto& b) { return a.swaps < b.swaps; });
}

std::vector<VatList> thesis_order(std::span<const VatList> layers) {
    std::vector<VatList> order(layers.begin(), layers.end());
    std::optional<int> last;
    for (VatList& layer : order) {
        if (layer.empty()) continue;
        if (const auto same = last ? std::find(layer.begin(), layer.end(), *last) : layer.end(); same != layer.end()) {
            std::rotate(layer.begin(), same, same + 1);
        }
        last = layer.back();
    }
    return order;
}

/// Backtracks through the table: each layer's beginning determines the ending of the layer before.
std::vector<VatList> cheapest_order(std::span<const VatList> layers) {
    const auto table = all_endings(layers);
    std::vector<VatList> order(layers.begin(), layers.end());
    std::optional<int> wanted;
    for (std::size_t i = layers.size(); i-- > 0;) {
        if (layers[i].empty()) continue;
        const auto found = std::find_if(table[i].begin(), table[i].end(),
                                        [&](const Ending& e) { return wanted && e.last == *wanted; });
        const Ending& ending = found != table[i].end() ? *found : cheapest_ending(table[i]);
        VatList& layer = order[i];
        const auto rank = [&](int vat) { return vat == ending.first ? 0 : (vat == ending.last ? 2 : 1); };
        std::stable_sort(layer.begin(), layer.end(), [&](int a, int b) { return rank(a) < rank(b); });
        wanted = ending.joined ? std::optional(ending.first) : std::nullopt;
    }
    return order;
}

}  // namespace

std::string_view rule_name(OrderRule rule) {
    constexpr std::string_view names[] = {"naive", "thesis", "fewest-swaps", "least-cost"};
    return names[static_cast<std::size_t>(rule)];
}

std::vector<VatList> order_vats(std::span<const VatList> layers, OrderRule rule) {
    if (rule == OrderRule::naive) return {layers.begin(), layers.end()};
    return rule == OrderRule::thesis ? thesis_order(layers) : cheapest_order(layers);
}

int count_swaps(std::span<const VatList> order) {
    int swaps = 0;
    std::optional<int> loaded;
    for (const VatList& layer : order) {
        for (const int vat : layer) {
            if (loaded && *loaded != vat) ++swaps;
            loaded = vat;
        }
    }
    return swaps;
}

int fewest_swaps(std::span<const VatList> layers) {
    const auto table = all_endings(layers);
    const auto last = std::find_if(table.rbegin(), table.rend(), [](const auto& layer) { return !layer.empty(); });
    return last == table.rend() ? 0 : cheapest_ending(*last).swaps;
}

}  // namespace pliant::plan
