#include "base/linalg/separator.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <utility>

using namespace pliant::linalg;

namespace {

struct Sides {
    Graph graph;
    std::vector<Side> sides;
};

/// Two rows of nodes with random edges between them, each node with a neighbour of its own on its outer side; the whole
/// first row separates left from right.
Sides two_rows(int left, int right, std::mt19937& random) {
    std::vector<std::pair<int, int>> edges;
    for (int a = 0; a < left; ++a) {
        edges.emplace_back(a, left + right + a);
        for (int b = 0; b < right; ++b) {
            if (random() % 5 == 0) edges.emplace_back(a, left + b);
        }
    }
    for (int b = 0; b < right; ++b) edges.emplace_back(left + b, 2 * left + right + b);
    Sides result;
    result.graph = graph_of(2 * (left + right), [&](const auto& use) {
        for (const auto& [a, b] : edges) {
            use(a, b);
            use(b, a);
        }
    });
    result.sides.assign(static_cast<std::size_t>(2 * (left + right)), Side::right);
    std::fill_n(result.sides.begin(), left, Side::separator);
    std::fill_n(result.sides.begin() + left + right, left, Side::left);
    return result;
}

bool separates(const Graph& graph, const std::vector<Side>& sides) {
    for (int i = 0; i < graph.nodes(); ++i) {
        for (int k = graph.start[i]; k < graph.start[i + 1]; ++k) {
            const Side a = sides[i], b = sides[graph.other[k]];
            if (a != b && a != Side::separator && b != Side::separator) return false;
        }
    }
    return true;
}

/// Size of the smallest vertex cover of the edges between the rows, by trying every subset of the first.
int smallest_cover(const Graph& graph, int left, int right) {
    int best = graph.nodes();
    for (unsigned chosen = 0; chosen < 1U << left; ++chosen) {
        std::vector<bool> needed(static_cast<std::size_t>(graph.nodes()), false);
        for (int a = 0; a < left; ++a) {
            for (int k = graph.start[a]; (chosen >> a & 1U) == 0 && k < graph.start[a + 1]; ++k)
                needed[graph.other[k]] = graph.other[k] < left + right;
        }
        const auto others = std::count(needed.begin(), needed.end(), true);
        best = std::min(best, std::popcount(chosen) + static_cast<int>(others));
    }
    return best;
}

}  // namespace

TEST_CASE("the separator between two rows is minimal") {
    std::mt19937 random(5);
    for (int trial = 0; trial < 200; ++trial) {
        const int left = 1 + static_cast<int>(random() % 10);
        const int right = 1 + static_cast<int>(random() % 10);
        Sides rows = two_rows(left, right, random);
        shrink_separator(rows.graph, rows.sides, 0);
        CHECK(separates(rows.graph, rows.sides));
        CHECK(std::count(rows.sides.begin(), rows.sides.end(), Side::separator) ==
              smallest_cover(rows.graph, left, right));
    }
}

TEST_CASE("no side drops below its minimum size") {
    std::mt19937 random(6);
    for (int trial = 0; trial < 50; ++trial) {
        Sides rows = two_rows(10, 3, random);
        shrink_separator(rows.graph, rows.sides, 4);
        CHECK(separates(rows.graph, rows.sides));
        CHECK(std::count(rows.sides.begin(), rows.sides.end(), Side::right) >= 4);
    }
}

TEST_CASE("a ragged separator of a grid becomes a straight one") {
    constexpr int width = 40, height = 10;
    const auto node = [](int i, int j) { return i * height + j; };
    const Graph graph = graph_of(width * height, [&](const auto& use) {
        for (int i = 0; i < width; ++i) {
            for (int j = 0; j < height; ++j) {
                if (i + 1 < width) use(node(i, j), node(i + 1, j)), use(node(i + 1, j), node(i, j));
                if (j + 1 < height) use(node(i, j), node(i, j + 1)), use(node(i, j + 1), node(i, j));
            }
        }
    });
    std::vector<Side> sides(width * height);
    for (int i = 0; i < width; ++i) {
        for (int j = 0; j < height; ++j) {
            const int middle = 20 + (j % 2 == 0 ? 1 : -1);
            sides[node(i, j)] = std::abs(i - middle) <= 1 ? Side::separator : i < middle ? Side::left : Side::right;
        }
    }
    REQUIRE(separates(graph, sides));
    shrink_separator(graph, sides, 100);
    CHECK(separates(graph, sides));
    CHECK(std::count(sides.begin(), sides.end(), Side::separator) == height);
}
