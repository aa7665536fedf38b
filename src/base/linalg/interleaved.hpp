// Vectors over the nodes of a matrix, for one column or several interleaved ones.
#pragma once

#include <algorithm>
#include <cstddef>

#include "base/core/aligned_array.hpp"
#include "base/core/parallel.hpp"

namespace pliant::linalg {

/// Numbers of all nodes, those of several columns interleaved.
template <class Real>
class Interleaved {
public:
    void resize(std::size_t size) {
        if (values_.size() == size) return;
        values_.resize(size);
        std::fill_n(values_.data(), size, Real(0));
    }
    [[nodiscard]] Real* data() const { return values_.data(); }
    [[nodiscard]] Real& operator[](std::size_t i) const { return values_[i]; }

private:
    AlignedArray<Real> values_;
};

/// body(i) for all i below `size`, on all cores.
template <class Body>
void for_numbers(std::size_t size, const Body& body) {
    constexpr std::size_t grain = 4096;  // numbers per parallel piece
    parallel_for(size, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) body(i);
    });
}

/// Scalar product of column `column` of `columns` interleaved ones of `size` numbers each; the same bits on any number
/// of cores.
template <class A, class B>
[[nodiscard]] double dot(const Interleaved<A>& a, const Interleaved<B>& b, std::size_t size, std::size_t columns = 1,
                         std::size_t column = 0) {
    constexpr std::size_t grain = 4096;
    return parallel_sum(size, grain, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin * columns + column; i < end * columns; i += columns)
            sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
        return sum;
    });
}

}  // namespace pliant::linalg
