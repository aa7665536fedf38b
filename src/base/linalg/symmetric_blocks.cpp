#include "base/linalg/symmetric_blocks.hpp"

#include <algorithm>
#include <cassert>

#include "base/core/parallel.hpp"
#include "base/linalg/symmetric_product.hpp"

namespace pliant::linalg {
namespace {

constexpr int columns_at_once = 1024, most_pieces = 32;  // of a product: at least so many, in at most so many pieces
constexpr std::size_t pairs_at_once = 4096, receivers_at_once = 1024;

/// Calls visit(at, in_four) for the numbers of a node: where they are among interleaved columns, and where if each
/// column has four.
template <std::size_t columns, class Visit>
void for_interleaved(const Visit& visit) {
    for (std::size_t c = 0; c < columns; ++c)
        for (std::size_t r = 0; r < 3; ++r) visit(columns * r + c, 4 * c + r);
}

/// to (columns, 4) <- the numbers of a node in x, and zeros.
template <std::size_t columns, class Real>
void spread(const Real* x, std::size_t node, Real* to) {
    for_interleaved<columns>([&](std::size_t at, std::size_t in_four) { to[in_four] = x[3 * columns * node + at]; });
    for (std::size_t c = 0; c < columns; ++c) to[4 * c + 3] = 0;
}

}  // namespace

SymmetricBlocks::SymmetricBlocks(const SymmetricPattern& pattern)
    : start_(pattern.node_start), row_(pattern.node_row), left_(blocks_left_of_diagonal(pattern)) {
    assert(pattern.block == 3);
    for (AlignedArray<float>* numbers : {&value_, &rest_}) {
        numbers->resize(9 * row_.size() + 1);  // kernels read columns four rows at a time
        (*numbers)[9 * row_.size()] = 0;
    }
    make_pieces();
}

void SymmetricBlocks::make_pieces() {
    const int columns = std::max(columns_at_once, (nodes() + most_pieces - 1) / most_pieces);
    for (int begin = 0; begin < nodes(); begin += columns)
        pieces_.push_back({begin, std::min(begin + columns, nodes()), 0, {}});
    place_.resize(row_.size());
    parallel_for(pieces_.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) find_halo(pieces_[p]);
    });
    for (std::size_t p = 1; p < pieces_.size(); ++p)
        pieces_[p].first_place = pieces_[p - 1].first_place + pieces_[p - 1].places();
    find_receivers();
}

void SymmetricBlocks::find_halo(Piece& piece) {
    const auto for_pairs = [&](const auto& use) {
        for (int k = start_[piece.begin]; k < start_[piece.end]; ++k) use(k);
    };
    for_pairs([&](int k) {
        if (row_[k] >= piece.end) piece.halo.push_back(row_[k]);
    });
    std::ranges::sort(piece.halo);
    piece.halo.erase(std::unique(piece.halo.begin(), piece.halo.end()), piece.halo.end());
    for_pairs([&](int k) {
        const auto in_halo = std::ranges::lower_bound(piece.halo, row_[k]) - piece.halo.begin();
        place_[k] = row_[k] < piece.end ? row_[k] - piece.begin : piece.end - piece.begin + static_cast<int>(in_halo);
    });
}

void SymmetricBlocks::find_receivers() {
    std::vector<std::pair<int, std::size_t>> given;  // row, place
    for (const Piece& piece : pieces_) {
        for (std::size_t h = 0; h < piece.halo.size(); ++h)
            given.emplace_back(piece.halo[h], piece.first_place + piece.own() + h);
    }
    std::ranges::sort(given);
    for (const auto& [row, place] : given) {
        if (receiver_.empty() || receiver_.back() != row) {
            receiver_.push_back(row);
            received_.start.push_back(received_.start.back());
        }
        received_.item.push_back(static_cast<int>(place));
        ++received_.start.back();
    }
}

Lists SymmetricBlocks::neighbours() const {
    return make_lists(nodes(), [&] {
        return [&](int i, std::vector<int>& list) { visit_neighbours(i, [&](int j) { list.push_back(j); }); };
    });
}

void SymmetricBlocks::set(std::span<const double> values) {
    parallel_for(row_.size(), pairs_at_once, [&](std::size_t begin, std::size_t end) {
        split(values.data() + 9 * begin, 9 * (end - begin), value_.data() + 9 * begin, rest_.data() + 9 * begin);
    });
    complete_diagonal();
}

void SymmetricBlocks::move_towards(std::span<const double> values, double share) {
    parallel_for(row_.size(), pairs_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const Eigen::Matrix3d now = block(static_cast<int>(k));
            const Eigen::Matrix3d given = Eigen::Map<const Eigen::Matrix3d>(values.data() + 9 * k);
            put(static_cast<int>(k), now + share * (given - now));
        }
    });
    complete_diagonal();
}

/// Of the diagonal blocks of the pattern the lower triangle counts.
void SymmetricBlocks::complete_diagonal() {
    parallel_for(start_.size() - 1, pairs_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (const AlignedArray<float>* numbers : {&value_, &rest_}) {
                float* const block = numbers->data() + 9 * static_cast<std::size_t>(start_[i]);
                block[3] = block[1];
                block[6] = block[2];
                block[7] = block[5];
            }
        }
    });
}

void SymmetricBlocks::put(int pair, const Eigen::Matrix3d& block) {
    split(block.data(), 9, value_.data() + 9 * static_cast<std::size_t>(pair),
          rest_.data() + 9 * static_cast<std::size_t>(pair));
}

/// Each piece multiplies its columns; what it gives to rows of other pieces is added afterwards, in order.
template <std::size_t columns, class Real, class Multiply>
void SymmetricBlocks::multiply_pieces(const Real* x, Real* y, WorkSpace<Real>& work, const Multiply& multiply) const {
    if (pieces_.empty()) return;
    constexpr std::size_t stride = 4 * columns;
    const std::size_t size = stride * (pieces_.back().first_place + pieces_.back().places());
    for (AlignedArray<Real>* numbers : {&work.from, &work.to})
        if (numbers->size() < size) numbers->resize(size);
    parallel_for(pieces_.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p < last; ++p) {
            const Piece& piece = pieces_[p];
            Real* const from = work.from.data() + stride * piece.first_place;
            Real* const to = work.to.data() + stride * piece.first_place;
            const auto own = static_cast<std::size_t>(piece.begin);
            for (std::size_t k = 0; k < piece.own(); ++k) spread<columns>(x, own + k, from + stride * k);
            for (std::size_t k = 0; k < piece.halo.size(); ++k)
                spread<columns>(x, static_cast<std::size_t>(piece.halo[k]), from + stride * (piece.own() + k));
            std::fill_n(to, stride * piece.places(), Real(0));
            multiply(BlockColumns{piece.own(), start_.data() + piece.begin, place_.data()}, from, to);
            for (std::size_t k = 0; k < piece.own(); ++k)
                for_interleaved<columns>([&](std::size_t at, std::size_t in_four) {
                    y[3 * columns * (own + k) + at] = to[stride * k + in_four];
                });
        }
    });
    parallel_for(receiver_.size(), receivers_at_once, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            Real* const row = y + 3 * columns * static_cast<std::size_t>(receiver_[i]);
            for (const int place : received_[i]) {
                const Real* const given = work.to.data() + stride * static_cast<std::size_t>(place);
                for_interleaved<columns>([&](std::size_t at, std::size_t in_four) { row[at] += given[in_four]; });
            }
        }
    });
}

void SymmetricBlocks::multiply(const double* x, double* y, int columns) {
    const auto by = [&](const BlockColumns& at, const double* from, double* to) {
        add_symmetric_product(at, SplitBlocks{value_.data(), rest_.data()}, columns, from, to);
    };
    columns == 1 ? multiply_pieces<1>(x, y, double_work_, by) : multiply_pieces<2>(x, y, double_work_, by);
}

void SymmetricBlocks::multiply(const float* x, float* y, int columns) {
    const auto by = [&](const BlockColumns& at, const float* from, float* to) {
        add_symmetric_product(at, value_.data(), columns, from, to);
    };
    columns == 1 ? multiply_pieces<1>(x, y, float_work_, by) : multiply_pieces<2>(x, y, float_work_, by);
}

}  // namespace pliant::linalg
