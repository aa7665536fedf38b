#include "loop/study/design.hpp"

#include <numeric>
#include <utility>

#include "loop/study/random.hpp"
#include "loop/study/sobol.hpp"

namespace pliant::study {

std::vector<double> latin_hypercube(std::size_t count, int dimensions, std::uint64_t seed) {
    std::vector<double> points(count * static_cast<std::size_t>(dimensions));
    Random random(seed);
    std::vector<std::size_t> layers(count);
    for (int d = 0; d < dimensions; ++d) {
        std::iota(layers.begin(), layers.end(), std::size_t{0});
        for (std::size_t i = count; i > 1; --i) std::swap(layers[i - 1], layers[random.below(i)]);
        for (std::size_t i = 0; i < count; ++i)
            points[i * dimensions + d] = (static_cast<double>(layers[i]) + random.share()) / static_cast<double>(count);
    }
    return points;
}

std::vector<double> saltelli_points(std::size_t count, int dimensions, std::uint64_t seed) {
    const std::vector<double> pairs = sobol_points(count, 2 * dimensions, seed);
    std::vector<double> points;
    points.reserve(count * static_cast<std::size_t>(dimensions) * static_cast<std::size_t>(dimensions + 2));
    for (std::size_t i = 0; i < count; ++i) {
        const auto a = pairs.begin() + static_cast<std::ptrdiff_t>(i) * 2 * dimensions;
        const auto b = a + dimensions;
        points.insert(points.end(), a, b);
        points.insert(points.end(), b, b + dimensions);
        for (int k = 0; k < dimensions; ++k) {
            points.insert(points.end(), a, b);
            *(points.end() - dimensions + k) = b[k];
        }
    }
    return points;
}

}  // namespace pliant::study
