#include "base/linalg/minimum_degree.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <set>

using namespace pliant::linalg;

TEST_CASE("each node in turn has the fewest remaining neighbours, those outside included") {
    std::mt19937 random(9);
    for (const int nodes : {1, 2, 17, 64, 65, 150}) {
        const int outside = nodes / 2;
        std::vector<std::set<int>> near(static_cast<std::size_t>(nodes));  // outside ones from `nodes` on
        std::vector<Rim> rim;
        for (int a = 0; a < nodes; ++a) {
            for (int k = 0; k < 3; ++k) {
                const int b = static_cast<int>(random() % static_cast<unsigned>(nodes));
                if (b != a) near[a].insert(b), near[b].insert(a);
            }
            if (outside == 0 || a % 3 != 0) continue;
            const int other = static_cast<int>(random() % static_cast<unsigned>(outside));
            near[a].insert(nodes + other);
            rim.push_back({1000 - other, a});
        }
        const Graph graph = graph_of(nodes, [&](const auto& use) {
            for (int a = 0; a < nodes; ++a) {
                for (const int b : near[a]) {
                    if (b < nodes) use(a, b);
                }
            }
        });
        const std::vector<int> order = by_minimum_degree(graph, rim);
        REQUIRE(order.size() == near.size());
        std::set<int> left;
        for (int a = 0; a < nodes; ++a) left.insert(a);
        for (const int v : order) {
            REQUIRE(left.count(v) == 1);
            for (const int other : left) CHECK(near[v].size() <= near[other].size());
            left.erase(v);
            for (const int a : near[v]) {
                if (a >= nodes) continue;
                near[a].insert(near[v].begin(), near[v].end());
                near[a].erase(a);
                near[a].erase(v);
            }
        }
    }
}
