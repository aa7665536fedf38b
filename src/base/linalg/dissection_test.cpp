#include "base/linalg/dissection.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <utility>

using namespace pliant::linalg;

namespace {

using Points = std::vector<std::array<double, 3>>;
using Edges = std::set<std::pair<int, int>>;

Graph graph_of_edges(int nodes, const Edges& edges) {
    return graph_of(nodes, [&](const auto& use) {
        for (const auto& [a, b] : edges) {
            use(a, b);
            use(b, a);
        }
    });
}

struct Grid {
    Graph graph;
    Points points;
};

/// Nodes adjacent along axes and diagonals.
Grid grid(int nx, int ny, int nz) {
    Grid result;
    Edges edges;
    const auto node = [&](int i, int j, int k) { return (i * ny + j) * nz + k; };
    for (int i = 0; i < nx; ++i) {
        for (int j = 0; j < ny; ++j) {
            for (int k = 0; k < nz; ++k) {
                result.points.push_back({1.0 * i, 1.0 * j, 1.0 * k});
                for (int step = 0; step < 27; ++step) {
                    const int a = i + step % 3 - 1, b = j + step / 3 % 3 - 1, c = k + step / 9 - 1;
                    const bool inside = a >= 0 && a < nx && b >= 0 && b < ny && c >= 0 && c < nz;
                    if (inside && node(a, b, c) > node(i, j, k)) edges.insert({node(i, j, k), node(a, b, c)});
                }
            }
        }
    }
    result.graph = graph_of_edges(nx * ny * nz, edges);
    return result;
}

bool is_permutation(std::vector<int> position) {
    std::sort(position.begin(), position.end());
    for (std::size_t k = 0; k < position.size(); ++k) {
        if (position[k] != static_cast<int>(k)) return false;
    }
    return true;
}

/// Entries of the factor including its diagonal, by naive elimination.
double factor_entries(const Graph& graph, const std::vector<int>& position) {
    std::vector<std::set<int>> later(position.size());
    for (int i = 0; i < graph.nodes(); ++i) {
        for (int k = graph.start[i]; k < graph.start[i + 1]; ++k)
            later[std::min(position[i], position[graph.other[k]])].insert(
                std::max(position[i], position[graph.other[k]]));
    }
    double entries = 0;
    for (std::set<int>& column : later) {
        entries += 1 + static_cast<double>(column.size());
        if (column.empty()) continue;
        const int parent = *column.begin();
        later[parent].insert(std::next(column.begin()), column.end());
    }
    return entries;
}

}  // namespace

TEST_CASE("every node of any graph gets a unique position, with and without coordinates") {
    const auto check = [](const Graph& graph, const Points& points) {
        CHECK(is_permutation(dissect(graph, points)));
        CHECK(is_permutation(dissect(graph)));
    };
    check(graph_of_edges(0, {}), {});
    check(graph_of_edges(1, {}), {{0, 0, 0}});
    check(graph_of_edges(300, {}), Points(300));  // no edges
    const Grid cube = grid(9, 9, 9);
    check(cube.graph, cube.points);
    check(cube.graph, Points(cube.points.size(), {1, 2, 3}));  // all points coincide
    Points far = cube.points;
    far[3] = {1e300, -1e300, 1e-300};
    check(cube.graph, far);

    Edges clique, star, path, random, two;
    std::mt19937 next(3);
    for (int a = 0; a < 200; ++a) {
        star.insert({0, a + 1});
        path.insert({a, a + 1});
        two.insert({a + (a >= 100 ? 1 : 0), a + 1 + (a >= 100 ? 1 : 0)});
        for (int b = 0; b < a; ++b) {
            clique.insert({b, a});
            if (next() % 40 == 0) random.insert({b, a});
        }
    }
    Points line;
    for (int a = 0; a < 202; ++a) line.push_back({0.1 * a, 0, 0});
    check(graph_of_edges(202, clique), line);
    check(graph_of_edges(202, star), line);
    check(graph_of_edges(202, path), line);
    check(graph_of_edges(202, random), line);
    check(graph_of_edges(202, two), line);
}

TEST_CASE("the fill of a square is that of George 1973, that of a chain or star minimal") {
    for (const int n : {15, 31, 63}) {
        const Grid square = grid(n, n, 1);
        const double bound = 7.75 * n * n * std::log2(n);
        CHECK(factor_entries(square.graph, dissect(square.graph, square.points)) < bound);
        CHECK(factor_entries(square.graph, dissect(square.graph)) < bound);
    }
    Edges chain, star;
    for (int a = 0; a < 1000; ++a) {
        chain.insert({a, a + 1});
        star.insert({a, 1000});
    }
    CHECK(factor_entries(graph_of_edges(1001, chain), dissect(graph_of_edges(1001, chain))) < 3.5 * 1001);
    CHECK(factor_entries(graph_of_edges(1001, star), dissect(graph_of_edges(1001, star))) == 2 * 1001 - 1);
}

TEST_CASE("a cube has no more fill than with mid-planes, and less than with rows") {
    const Grid cube = grid(15, 15, 15);
    std::vector<int> rows(cube.points.size());
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = static_cast<int>(k);
    const double by_rows = factor_entries(cube.graph, rows);
    CHECK(factor_entries(cube.graph, dissect(cube.graph, cube.points)) < 0.5 * by_rows);
    CHECK(factor_entries(cube.graph, dissect(cube.graph)) < 0.6 * by_rows);
}

TEST_CASE("the order is the same on any number of cores") {
    const Grid bar = grid(60, 12, 12);
    const std::vector<int> expected = dissect(bar.graph, bar.points);
    for (const std::size_t cores : {1, 2, 5}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, cores);
        CHECK(dissect(bar.graph, bar.points) == expected);
    }
}
