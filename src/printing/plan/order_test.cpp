#include "printing/plan/order.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "printing/plan/test_jobs.hpp"

using namespace pliant::plan;
using pliant::plan::test::repeated;

namespace {

/// The least number of swaps by trying every order of every layer.
int brute_force(std::vector<VatList> layers) {
    int best = std::numeric_limits<int>::max();
    for (VatList& layer : layers) std::sort(layer.begin(), layer.end());
    for (;;) {
        best = std::min(best, count_swaps(layers));
        std::size_t i = 0;
        while (i < layers.size() && !std::next_permutation(layers[i].begin(), layers[i].end())) ++i;
        if (i == layers.size()) return best;
    }
}

void check_all(const std::vector<VatList>& layers, int naive, int thesis, int fewest) {
    CHECK(count_swaps(layers) == naive);
    CHECK(count_swaps(order_vats(layers)) == thesis);
    CHECK(fewest_swaps(layers) == fewest);
    CHECK(count_swaps(order_vats(layers, OrderRule::fewest_swaps)) == fewest);
}

}  // namespace

TEST_CASE("two halves: 399 swaps in a fixed order, 200 by the rule of the thesis, and no order needs fewer") {
    check_all(repeated({0, 1}, 200), 399, 200, 200);
}

TEST_CASE("stack of four slabs: 3 swaps") {
    std::vector<VatList> layers;
    for (int m = 0; m < 4; ++m) layers.insert(layers.end(), 40, {m});
    check_all(layers, 3, 3, 3);
}

TEST_CASE("ten alternating bands: 9 swaps") {
    std::vector<VatList> layers;
    for (int band = 0; band < 10; ++band) layers.insert(layers.end(), 20, {band % 2});
    check_all(layers, 9, 9, 9);
}

TEST_CASE("eight materials in every layer: 1599 swaps in a fixed order, 1400 by the rule") {
    VatList all(8);
    std::iota(all.begin(), all.end(), 0);
    check_all(repeated(all, 200), 1599, 1400, 1400);
}

TEST_CASE("blank layers are skipped, and an empty job needs no swap") {
    check_all({{}, {0}, {}, {0, 1}, {}, {1}, {}}, 1, 1, 1);
    check_all({}, 0, 0, 0);
    check_all({{}, {}}, 0, 0, 0);
}

TEST_CASE("the thesis' rule does not look ahead and needs more swaps than the least number") {
    check_all({{0, 1, 2}, {0}}, 3, 3, 2);
    check_all({{0, 1}, {0, 2}, {1, 2}}, 5, 4, 3);
}

TEST_CASE("the bound agrees with trying every order") {
    unsigned state = 7;
    const auto random = [&](unsigned n) { return ((state = state * 1664525u + 1013904223u) >> 16) % n; };
    for (int round = 0; round < 60; ++round) {
        std::vector<VatList> layers(5);
        for (VatList& layer : layers) {
            for (int vat = 0; vat < 4; ++vat) {
                if (random(2) == 0 && layer.size() < 3) layer.push_back(vat);
            }
        }
        const int best = brute_force(layers);
        CHECK(fewest_swaps(layers) == best);
        CHECK(count_swaps(order_vats(layers, OrderRule::fewest_swaps)) == best);
        CHECK(count_swaps(order_vats(layers)) >= best);
    }
}
