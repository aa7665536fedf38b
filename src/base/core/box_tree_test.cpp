#include "base/core/box_tree.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <utility>

using namespace pliant;

namespace {

using IndexPairs = std::vector<std::pair<int, int>>;

Vec3 random_vector(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    return {uniform(random), uniform(random), uniform(random)};
}

std::vector<Bounds> random_boxes(std::size_t count, double size, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Bounds> boxes(count);
    for (Bounds& b : boxes) {
        const Vec3 at = random_vector(random);
        b.add(at);
        b.add(at + size * random_vector(random));
    }
    return boxes;
}

IndexPairs by_tree(const BoxTree& a, const std::vector<Bounds>& in_a, const BoxTree& b,
                   const std::vector<Bounds>& in_b) {
    IndexPairs found;
    const BoxTree::Fit fit_a = a.fit(in_a), fit_b = b.fit(in_b);
    for (std::size_t l = 0; l < a.leaf_count(); ++l)
        a.visit_overlaps(fit_a, l, b, fit_b, [&](int i, int j) {
            found.emplace_back(&a == &b ? std::min(i, j) : i, &a == &b ? std::max(i, j) : j);
        });
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace

TEST_CASE("a tree finds the same overlaps as testing all pairs, after its boxes have moved") {
    for (const std::size_t count : {1u, 7u, 8u, 9u, 64u, 333u}) {
        CAPTURE(count);
        const BoxTree tree(random_boxes(count, 0.1, 1)), other(random_boxes(2 * count + 1, 0.1, 2));
        const auto now = random_boxes(count, 0.3, 5), there = random_boxes(2 * count + 1, 0.2, 6);
        IndexPairs own, both;
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t j = i + 1; j < count; ++j)
                if (now[i].overlaps(now[j])) own.emplace_back(i, j);
            for (std::size_t j = 0; j < there.size(); ++j)
                if (now[i].overlaps(there[j])) both.emplace_back(i, j);
        }
        CHECK(by_tree(tree, now, tree, now) == own);
        CHECK(by_tree(tree, now, other, there) == both);
    }
}

TEST_CASE("boxes that only touch overlap, and an empty tree finds nothing") {
    Bounds a, b;
    a.add(Vec3{0, 0, 0});
    a.add(Vec3{1, 1, 1});
    b.add(Vec3{1, 0, 0});
    b.add(Vec3{2, 1, 1});
    CHECK(a.overlaps(b));
    b.low[0] = 1.001;
    CHECK_FALSE(a.overlaps(b));
    const BoxTree empty(std::span<const Bounds>{});
    CHECK(empty.leaf_count() == 0);
    CHECK(empty.fit({}).nodes.empty());
}
