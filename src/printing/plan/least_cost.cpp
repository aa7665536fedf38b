#include "printing/plan/least_cost.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>

namespace pliant::plan {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::size_t most_exact = 12;
constexpr double most_work = 2e9;  // elementary steps for all sets together

/// The cheapest paths through one set of vats.
class SetPaths {
public:
    SetPaths(const VatList& vats, const ChangeCosts& costs, bool may_try_all)
        : vats_(vats), costs_(costs), n_(vats.size()), cost_(n_ * n_, infinite) {
        if (n_ == 1) {
            cost_[0] = 0;
        } else if (even()) {
            const double all = static_cast<double>(n_ - 1) * costs.between(vats[0], vats[1]);
            for (std::size_t i = 0; i < n_ * n_; ++i) cost_[i] = i / n_ == i % n_ ? infinite : all;
        } else if (may_try_all) {
            for (std::size_t first = 0; first < n_; ++first) held_karp(first, nullptr);
        } else {
            exact_ = false;
            for (std::size_t i = 0; i < n_ * n_; ++i) {
                if (i / n_ != i % n_) cost_[i] = length(nearest_first(i / n_, i % n_));
            }
        }
        even_ = n_ > 1 && even();
    }

    [[nodiscard]] const VatList& vats() const { return vats_; }
    [[nodiscard]] double cost(std::size_t first, std::size_t last) const { return cost_[first * n_ + last]; }
    [[nodiscard]] bool exact() const { return exact_; }

    /// The vats in the order of that path.
    [[nodiscard]] const VatList& path(std::size_t first, std::size_t last) {
        VatList& found = paths_[first * n_ + last];
        if (found.empty()) found = find_path(first, last);
        return found;
    }

private:
    [[nodiscard]] double between(std::size_t a, std::size_t b) const { return costs_.between(vats_[a], vats_[b]); }

    /// Whether every change within the set costs the same.
    [[nodiscard]] bool even() const {
        const double one = between(0, 1);
        for (std::size_t a = 0; a < n_; ++a) {
            for (std::size_t b = 0; b < n_; ++b) {
                if (a != b && between(a, b) != one) return false;
            }
        }
        return true;
    }

    /// Costs of the paths from `first` to every last vat; `before`, if not null, gets the predecessor of each vat in
    /// each subset.
    void held_karp(std::size_t first, std::vector<std::uint8_t>* before) {
        const std::size_t sets = std::size_t{1} << n_;
        std::vector<double> best(sets * n_, infinite);
        best[(std::size_t{1} << first) * n_ + first] = 0;
        for (std::size_t set = 1; set < sets; ++set) {
            for (std::size_t at = 0; at < n_; ++at) {
                const double so_far = best[set * n_ + at];
                if (so_far == infinite) continue;
                for (std::size_t next = 0; next < n_; ++next) {
                    const std::size_t wider = set | (std::size_t{1} << next);
                    if (wider == set || so_far + between(at, next) >= best[wider * n_ + next]) continue;
                    best[wider * n_ + next] = so_far + between(at, next);
                    if (before != nullptr) (*before)[wider * n_ + next] = static_cast<std::uint8_t>(at);
                }
            }
        }
        for (std::size_t last = 0; last < n_; ++last) cost_[first * n_ + last] = best[(sets - 1) * n_ + last];
        if (n_ > 1) cost_[first * n_ + first] = infinite;
    }

    [[nodiscard]] VatList find_path(std::size_t first, std::size_t last) {
        if (n_ == 1) return vats_;
        if (even_ || !exact_) return even_ ? as_listed(first, last) : nearest_first(first, last);
        std::vector<std::uint8_t> before((std::size_t{1} << n_) * n_);
        held_karp(first, &before);
        VatList path(n_);
        std::size_t set = (std::size_t{1} << n_) - 1;
        std::size_t at = last;
        for (std::size_t i = n_; i-- > 0;) {
            path[i] = vats_[at];
            const std::size_t previous = before[set * n_ + at];
            set &= ~(std::size_t{1} << at);
            at = previous;
        }
        return path;
    }

    [[nodiscard]] VatList as_listed(std::size_t first, std::size_t last) const {
        VatList path = {vats_[first]};
        for (std::size_t i = 0; i < n_; ++i) {
            if (i != first && i != last) path.push_back(vats_[i]);
        }
        path.push_back(vats_[last]);
        return path;
    }

    [[nodiscard]] VatList nearest_first(std::size_t first, std::size_t last) const {
        VatList path = as_listed(first, last);
        for (auto at = path.begin(); at + 2 < path.end(); ++at) {
            const auto nearest = std::min_element(
                at + 1, path.end() - 1, [&](int a, int b) { return costs_.between(*at, a) < costs_.between(*at, b); });
            std::iter_swap(at + 1, nearest);
        }
        return path;
    }

    [[nodiscard]] double length(const VatList& path) const {
        double sum = 0;
        for (std::size_t i = 1; i < path.size(); ++i) sum += costs_.between(path[i - 1], path[i]);
        return sum;
    }

    VatList vats_;
    const ChangeCosts& costs_;
    std::size_t n_;
    std::vector<double> cost_;  ///< (first, last)
    bool even_ = false;
    bool exact_ = true;
    std::map<std::size_t, VatList> paths_;
};

/// The sets of vats that occur in layers, each with its paths.
class PathBook {
public:
    explicit PathBook(const ChangeCosts& costs) : costs_(costs) {}

    SetPaths& of(const VatList& layer) {
        if (last_ != nullptr && last_->vats() == layer) return *last_;
        auto found = sets_.find(layer);
        if (found == sets_.end()) {
            const auto k = static_cast<double>(layer.size());
            const double work = layer.size() <= most_exact ? k * k * k * static_cast<double>(1U << layer.size()) : 0;
            const bool may_try_all = layer.size() <= most_exact && work_ + work <= most_work;
            work_ += may_try_all ? work : 0;
            found = sets_.try_emplace(layer, layer, costs_, may_try_all).first;
        }
        last_ = &found->second;
        return *last_;
    }

private:
    const ChangeCosts& costs_;
    std::map<VatList, SetPaths> sets_;
    SetPaths* last_ = nullptr;
    double work_ = 0;
};

/// The cheapest order of all layers up to this one that ends with a certain vat.
struct Stop {
    double cost = infinite;
    std::size_t first = 0;     ///< the first vat of this layer
    std::size_t previous = 0;  ///< the last vat of the previous layer
};

struct LayerStep {
    SetPaths* paths = nullptr;
    std::size_t layer = 0;
    std::vector<Stop> stops;  ///< by last vat, in the order of the set
};

/// Cheapest arrival at each vat of `now` from the stops of the previous layer; nullptr: nothing is loaded yet.
std::vector<Stop> arrivals(const LayerStep* before, const VatList& now, const ChangeCosts& costs) {
    std::vector<Stop> arrive(now.size());
    for (std::size_t f = 0; f < now.size(); ++f) {
        if (before == nullptr) {
            arrive[f].cost = costs.load[static_cast<std::size_t>(now[f])];
            continue;
        }
        const VatList& vats = before->paths->vats();
        for (std::size_t p = 0; p < vats.size(); ++p) {
            const double cost = before->stops[p].cost + costs.between(vats[p], now[f]);
            if (cost < arrive[f].cost) arrive[f] = {cost, f, p};
        }
    }
    return arrive;
}

LayerStep next_step(const LayerStep* before, std::size_t layer, SetPaths& paths, const ChangeCosts& costs) {
    const std::size_t n = paths.vats().size();
    const std::vector<Stop> arrive = arrivals(before, paths.vats(), costs);
    LayerStep step{&paths, layer, std::vector<Stop>(n)};
    for (std::size_t f = 0; f < n; ++f) {
        for (std::size_t l = 0; l < n; ++l) {
            const double cost = arrive[f].cost + paths.cost(f, l);
            if (cost < step.stops[l].cost) step.stops[l] = {cost, f, arrive[f].previous};
        }
    }
    return step;
}

}  // namespace

ChangeCosts::ChangeCosts(int vat_count)
    : vats(vat_count),
      swap(static_cast<std::size_t>(vat_count) * static_cast<std::size_t>(vat_count)),
      load(static_cast<std::size_t>(vat_count)),
      store(static_cast<std::size_t>(vat_count)) {}

double change_cost(std::span<const VatList> order, const ChangeCosts& costs) {
    double sum = 0;
    int loaded = -1;
    for (const VatList& layer : order) {
        for (const int vat : layer) {
            sum += loaded < 0 ? costs.load[static_cast<std::size_t>(vat)] : costs.between(loaded, vat);
            loaded = vat;
        }
    }
    return loaded < 0 ? 0 : sum + costs.store[static_cast<std::size_t>(loaded)];
}

LeastCost least_cost_order(std::span<const VatList> layers, const ChangeCosts& costs) {
    LeastCost result;
    result.order.assign(layers.size(), {});
    PathBook book(costs);
    std::vector<LayerStep> steps;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        if (layers[i].empty()) continue;
        SetPaths& paths = book.of(layers[i]);
        result.exact = result.exact && paths.exact();
        LayerStep step = next_step(steps.empty() ? nullptr : &steps.back(), i, paths, costs);
        steps.push_back(std::move(step));
    }
    if (steps.empty()) return result;
    const VatList& ends = steps.back().paths->vats();
    std::size_t last = 0;
    result.cost = infinite;
    for (std::size_t l = 0; l < ends.size(); ++l) {
        const double cost = steps.back().stops[l].cost + costs.store[static_cast<std::size_t>(ends[l])];
        if (cost < result.cost) result.cost = cost, last = l;
    }
    for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
        const Stop& stop = step->stops[last];
        result.order[step->layer] = step->paths->path(stop.first, last);
        last = stop.previous;
    }
    return result;
}

}  // namespace pliant::plan
