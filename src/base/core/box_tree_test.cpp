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

/// Boxes at both ends of a motion; those that begin on one side of a plane stay where they are.
struct Moving {
    Moving(std::size_t count, unsigned seed)
        : start(random_boxes(count, 0.1, seed)), end(random_boxes(count, 0.1, seed + 1)), moves(count) {
        for (std::size_t i = 0; i < count; ++i) {
            moves[i] = start[i].low[0] > 0.2 ? 1 : 0;
            if (moves[i] == 0) end[i] = start[i];
        }
    }
    [[nodiscard]] MovingBounds at(std::size_t i) const { return {start[i], end[i]}; }
    std::vector<Bounds> start, end;
    std::vector<char> moves;
};

IndexPairs meetings_by_tree(const BoxTree& a, const Moving& in_a, const BoxTree& b, const Moving& in_b) {
    IndexPairs found;
    const auto fit_a = a.fit(in_a.start, in_a.end, in_a.moves), fit_b = b.fit(in_b.start, in_b.end, in_b.moves);
    for (std::size_t l = 0; l < a.leaf_count(); ++l)
        a.visit_meetings(fit_a, l, b, fit_b, [&](int i, int j) {
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

TEST_CASE("a tree finds what may meet on the way and moves, and few that do not move") {
    for (const std::size_t count : {1u, 8u, 64u, 333u}) {
        CAPTURE(count);
        const Moving first(count, 3), second(2 * count + 1, 7);
        const BoxTree tree(first.start), other(second.start);
        std::size_t still_pairs = 0;
        const auto check = [&](const IndexPairs& found, const Moving& a, const Moving& b, bool self) {
            CHECK(std::adjacent_find(found.begin(), found.end()) == found.end());
            IndexPairs wanted;
            for (std::size_t i = 0; i < a.start.size(); ++i) {
                for (std::size_t j = self ? i + 1 : 0; j < b.start.size(); ++j) {
                    if (!a.at(i).may_meet(b.at(j))) continue;
                    if (a.moves[i] == 0 && b.moves[j] == 0)
                        ++still_pairs;
                    else
                        wanted.emplace_back(i, j);
                }
            }
            IndexPairs moving = found;
            std::erase_if(moving, [&](const auto& pair) {
                return a.moves[static_cast<std::size_t>(pair.first)] == 0 &&
                       b.moves[static_cast<std::size_t>(pair.second)] == 0;
            });
            CHECK(moving == wanted);
            return found.size() - moving.size();
        };
        const std::size_t found_still = check(meetings_by_tree(tree, first, tree, first), first, first, true) +
                                        check(meetings_by_tree(tree, first, other, second), first, second, false);
        if (count == 333) CHECK(found_still < still_pairs / 4);
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
