#include "printing/plan/least_cost.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "base/core/near.hpp"

using namespace pliant::plan;
using pliant::near;

namespace {

ChangeCosts random_costs(int vats, std::mt19937& random) {
    ChangeCosts costs(vats);
    std::uniform_int_distribution<int> seconds(1, 40);
    for (auto* list : {&costs.swap, &costs.load, &costs.store}) {
        for (double& c : *list) c = seconds(random);
    }
    return costs;
}

std::vector<VatList> random_layers(int layers, int vats, std::mt19937& random) {
    std::vector<VatList> all(static_cast<std::size_t>(layers));
    for (VatList& layer : all) {
        for (int vat = 0; vat < vats; ++vat) {
            if (random() % 2 == 0 && layer.size() < 3) layer.push_back(vat);
        }
    }
    return all;
}

/// Tries every order of every layer.
double brute_force_cost(std::vector<VatList> layers, const ChangeCosts& costs) {
    double best = std::numeric_limits<double>::max();
    for (VatList& layer : layers) std::sort(layer.begin(), layer.end());
    for (;;) {
        best = std::min(best, change_cost(layers, costs));
        std::size_t i = 0;
        while (i < layers.size() && !std::next_permutation(layers[i].begin(), layers[i].end())) ++i;
        if (i == layers.size()) return best;
    }
}

ChangeCosts even_costs(int vats, double swap) {
    ChangeCosts costs(vats);
    std::fill(costs.swap.begin(), costs.swap.end(), swap);
    return costs;
}

}  // namespace

TEST_CASE("the least cost agrees with trying every order, and the returned order has it") {
    std::mt19937 random(7);
    for (int round = 0; round < 150; ++round) {
        const ChangeCosts costs = random_costs(5, random);
        const std::vector<VatList> layers = random_layers(5, 5, random);
        const LeastCost found = least_cost_order(layers, costs);
        CHECK(found.exact);
        CHECK(found.cost == near(brute_force_cost(layers, costs), {.relative = 1e-12}));
        CHECK(change_cost(found.order, costs) == near(found.cost, {.relative = 1e-12}));
        for (std::size_t i = 0; i < layers.size(); ++i) {
            CHECK(
                std::is_permutation(layers[i].begin(), layers[i].end(), found.order[i].begin(), found.order[i].end()));
        }
    }
}

TEST_CASE("one layer of seven vats: the cheapest order of all") {
    std::mt19937 random(3);
    for (int round = 0; round < 10; ++round) {
        const ChangeCosts costs = random_costs(7, random);
        const std::vector<VatList> layers = {{0, 1, 2, 3, 4, 5, 6}};
        CHECK(least_cost_order(layers, costs).cost == near(brute_force_cost(layers, costs), {.relative = 1e-12}));
    }
}

TEST_CASE("with equal costs the least cost is the fewest swaps") {
    std::mt19937 random(11);
    for (int round = 0; round < 50; ++round) {
        const std::vector<VatList> layers = random_layers(8, 6, random);
        const LeastCost found = least_cost_order(layers, even_costs(6, 62));
        CHECK(found.cost == near(62.0 * fewest_swaps(layers), {.relative = 1e-12}));
        CHECK(count_swaps(found.order) == fewest_swaps(layers));
    }
}

TEST_CASE("an expensive pair is avoided even if the tower moves farther") {
    ChangeCosts costs = even_costs(3, 60);
    costs.swap[costs.at(0, 2)] = 500;
    costs.load = {0, 100, 100};
    const LeastCost found = least_cost_order(std::vector<VatList>{{0, 1, 2}}, costs);
    CHECK(found.order[0] == VatList{0, 1, 2});
    CHECK(found.cost == 120);
}

TEST_CASE("too many vats in a layer for an exact search give a complete order, marked as not exact") {
    std::mt19937 random(5);
    const ChangeCosts costs = random_costs(40, random);
    VatList all(40);
    for (int v = 0; v < 40; ++v) all[static_cast<std::size_t>(v)] = v;
    const LeastCost found = least_cost_order(std::vector<VatList>{all, all}, costs);
    CHECK_FALSE(found.exact);
    CHECK(std::is_permutation(all.begin(), all.end(), found.order[1].begin()));
    CHECK(least_cost_order(std::vector<VatList>{all, all}, even_costs(40, 1)).exact);
}

TEST_CASE("layers without material cost nothing") {
    const LeastCost found = least_cost_order(std::vector<VatList>{{}, {}}, even_costs(2, 5));
    CHECK(found.cost == 0);
    CHECK(found.order.size() == 2);
}
