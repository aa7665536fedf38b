#include "simulation/elements/block_sums.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "simulation/elements/element_kernels.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

constexpr std::size_t pairs = 10;

/// Slots of batches that use blocks `reach` to both sides of their share of all, so that neighbours have some in
/// common; every seventh pair has none, every third is transposed.
std::vector<int> slots_of(std::size_t batches, std::size_t blocks, double reach, std::mt19937& random) {
    std::vector<int> slots;
    for (std::size_t b = 0; b < batches; ++b) {
        for (std::size_t k = 0; k < pairs * batch_lanes; ++k) {
            const double middle = static_cast<double>(b) / static_cast<double>(batches);
            const double at = std::uniform_real_distribution<double>(middle - reach, middle + reach)(random);
            const double block = std::clamp(at, 0.0, 1.0) * static_cast<double>(blocks - 1);
            slots.push_back(k % 7 == 0 ? BlockSums::no_slot : 2 * static_cast<int>(block) + (k % 3 == 0 ? 1 : 0));
        }
    }
    return slots;
}

/// What lane `l` of a pair adds as its number `i`.
double written(std::size_t batch, std::size_t pair, std::size_t i, std::size_t l) {
    return std::cos(static_cast<double>(batch) + 0.37 * static_cast<double>(pair * 9 + i) +
                    2.1 * static_cast<double>(l));
}

}  // namespace

TEST_CASE("contributions of tets are summed in their blocks, however many tets share a block") {
    std::mt19937 random(5);
    for (const auto& [batches, reach] : {std::pair<std::size_t, double>{1, 1}, {300, 0.01}, {2500, 0.02}, {600, 0.8}}) {
        const std::size_t blocks = 20 * batches;
        const std::vector<int> slots = slots_of(batches, blocks, reach, random);
        const BlockSums sums(slots, batches, blocks);
        ArrayPool<double> scratch;
        for (const std::size_t size : {1U, 9U}) {
            std::vector<double> expected(blocks * size, 1.0), result = expected;
            for (std::size_t b = 0; b < batches; ++b) {
                for (std::size_t k = 0; k < pairs * batch_lanes; ++k) {
                    const int slot = slots[b * pairs * batch_lanes + k];
                    for (std::size_t i = 0; slot != BlockSums::no_slot && i < size; ++i) {
                        const std::size_t to = size == 9 && slot % 2 == 1 ? i % 3 * 3 + i / 3 : i;
                        expected[static_cast<std::size_t>(slot / 2) * size + to] +=
                            written(b, k / batch_lanes, i, k % batch_lanes);
                    }
                }
            }
            sums.add(
                [&](std::size_t batch, double* to) {
                    for (std::size_t k = 0; k < pairs * size * batch_lanes; ++k)
                        to[k] = written(batch, k / batch_lanes / size, k / batch_lanes % size, k % batch_lanes);
                },
                size, result, scratch);
            double wrong = 0;
            for (std::size_t k = 0; k < expected.size(); ++k)
                wrong = std::max(wrong, std::fabs(result[k] - expected[k]));
            CHECK(wrong < 1e-12);
        }
    }
}
