#include "linalg/aggregates.hpp"

namespace pliant::linalg {

Aggregates aggregate(const BlockRows& matrix) {
    const int nodes = matrix.rows();
    Aggregates result{std::vector<int>(static_cast<std::size_t>(nodes), -1)};
    auto& of = result.of_node;
    const auto for_neighbours = [&](int i, const auto& use) {
        for (int k = matrix.start[i]; k < matrix.start[i + 1]; ++k) use(matrix.column[k]);
    };
    // Whole neighbourhoods that nobody has taken; what is left between them joins one that it touches.
    for (int i = 0; i < nodes; ++i) {
        bool untouched = true;
        for_neighbours(i, [&](int j) { untouched = untouched && of[j] < 0; });
        if (!untouched) continue;
        for_neighbours(i, [&](int j) { of[j] = result.count; });
        ++result.count;
    }
    const std::vector<int> first = of;
    for (int i = 0; i < nodes; ++i) {
        if (of[i] >= 0) continue;
        for_neighbours(i, [&](int j) {
            if (of[i] < 0) of[i] = first[j];
        });
    }
    for (int i = 0; i < nodes; ++i) {
        if (of[i] >= 0) continue;
        for_neighbours(i, [&](int j) {
            if (of[j] < 0) of[j] = result.count;
        });
        ++result.count;
    }
    return result;
}

}  // namespace pliant::linalg
