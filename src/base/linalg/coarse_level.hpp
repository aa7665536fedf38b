// The coarse level of a two-level solver (TwoLevel): fewer unknowns, with restriction and prolongation.
#pragma once

#include <span>
#include <vector>

#include "base/linalg/sparse.hpp"
#include "base/linalg/symmetric_blocks.hpp"

namespace pliant::linalg {

/// How much of an earlier coarse level serves a new matrix: all of it, rotated with the nodes; all of it as it is,
/// because it was made for this very matrix; or nothing.
enum class Reuse { turned, kept, none };

class CoarseLevel {
public:
    /// The fine level: the matrix A; the node positions (nodes, 3); the inverses of its diagonal blocks D (nodes, 9);
    /// and 4/3 of the inverse of the largest eigenvalue of D^-1 A.
    struct Fine {
        const SymmetricBlocks& matrix;
        std::span<const double> positions;
        const float* inverse_diagonal;
        float damping;
    };

    virtual ~CoarseLevel() = default;

    virtual void set(const Fine& fine) = 0;
    /// Reuses everything from the last set(), rotated with the nodes, which are now at `positions`. False: this level
    /// cannot be rotated, but set() is fast. Precondition: set() was called.
    [[nodiscard]] virtual bool turn(std::span<const double> positions) = 0;
    /// Reuses everything from the last set() as it is. False: this level cannot, but set() is fast.
    [[nodiscard]] virtual bool turn_back() = 0;

    /// Pattern and values of P^T A P, as of the last set(). Blocks of 3.
    [[nodiscard]] virtual const SymmetricPattern& pattern() const = 0;
    [[nodiscard]] virtual std::span<const double> values() const = 0;

    /// (nodes of the pattern, 3) where its nodes are, as of the last set(); none if they are not at places.
    [[nodiscard]] virtual std::span<const double> positions() const { return {}; }

    /// coarse (size of the pattern) <- P^T fine.
    virtual void restrict(const float* fine, double* coarse) = 0;
    /// fine += P coarse.
    virtual void add_prolonged(const double* coarse, float* fine) const = 0;
};

}  // namespace pliant::linalg
