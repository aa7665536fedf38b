// Dense kernels of a sparse factorisation, in SIMD: panels of a supernode and their updates of the remaining matrix.
#pragma once

#include <cstddef>
#include <span>

namespace pliant::linalg {

/// Number of rows that are stored together: one cache line.
template <class Real>
inline constexpr int packet = static_cast<int>(64 / sizeof(Real));

template <class Real>
[[nodiscard]] constexpr int whole_packets(int rows) {
    return (rows + packet<Real> - 1) / packet<Real> * packet<Real>;
}

/// The columns of one supernode, in packets of rows: entry (r, c) is values[(r / P * columns + c) * P + r % P] with
/// P = packet<Real>. First come the supernode's own rows, padded with zeros to a whole packet, then the rows below.
/// `values` is aligned to 64 bytes.
template <class Real>
struct Panel {
    Real* values;
    int columns;
    int below;  ///< rows below

    [[nodiscard]] int first_below() const { return whole_packets<Real>(columns); }
    [[nodiscard]] int rows() const { return first_below() + whole_packets<Real>(below); }
    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(rows()) * columns; }
    [[nodiscard]] Real* at(int r, int c) const {
        constexpr int P = packet<Real>;
        return values + (static_cast<std::size_t>(r / P) * columns + c) * P + r % P;
    }
};

/// Replaces A = L L^T (its lower triangle) and the rows B below by L and B L^-T. False if A is not positive definite.
/// Wide panels use all cores; the result is bit-identical on any number of them.
template <class Real>
[[nodiscard]] bool factorise(const Panel<Real>& panel);

/// The panel's contribution to the matrix of its rows below: update = -L L^T, (below, below) by columns with leading
/// dimension whole_packets(below). Only the lower triangle is valid; a little more is written.
template <class Real>
void negative_product(const Panel<Real>& panel, Real* update);

/// Nodes of a child's update that are contiguous in its parent, too.
struct Stretch {
    int from, to, length;
};

/// Adds the lower triangle of the child update `from`, at the nodes of the stretches, to the panel and, at the nodes
/// after the panel's own, to `update`. Both updates are as negative_product() makes them. `block` rows and columns per
/// node. Large updates use all cores.
template <class Real>
void add_to_panel(const Real* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                  const Panel<Real>& panel);
template <class Real>
void add_to_update(const Real* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                   const Panel<Real>& panel, Real* update);

/// x (columns, count) <- L^-1 x, and y (rows below, padded to packets, count) = L_below x. Vectors one after the other.
template <class Real>
void solve_lower(const Panel<Real>& panel, int count, Real* x, Real* y);
/// x <- L^-T (x - L_below^T y).
template <class Real>
void solve_upper(const Panel<Real>& panel, int count, Real* x, const Real* y);

/// Number of right-hand sides that are interleaved, unknown by unknown.
inline constexpr int lanes = 8;
/// The rows below a panel, as indices into arrays of all unknowns, (unknowns, lanes), aligned to whole unknowns.
template <class Real>
struct LaneRows {
    const int* position;  ///< (rows below)
    Real* all;
    Real* beyond;  ///< the rows of unknowns from `limit` on
    int limit;

    [[nodiscard]] Real* at(int row) const {
        return (position[row] < limit ? all : beyond) + static_cast<std::size_t>(position[row]) * lanes;
    }
};
/// x (columns, lanes) <- L^-1 x; rows -= L_below x, in place: each number of the panel is read once for all lanes, and
/// narrow panels cost little.
template <class Real>
void solve_lower_lanes(const Panel<Real>& panel, Real* x, const LaneRows<Real>& rows);
/// x <- L^-T (x - L_below^T rows).
template <class Real>
void solve_upper_lanes(const Panel<Real>& panel, Real* x, const LaneRows<Real>& rows);

/// sums (lanes, lanes) += a^T b, for a and b (count, lanes).
template <class Real>
void add_lane_products(int count, const Real* a, const Real* b, Real* sums);

}  // namespace pliant::linalg
