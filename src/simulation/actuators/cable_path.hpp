// The geometry of one cable or spring: its length and how the length changes with the nodes.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "base/core/vec3.hpp"
#include "base/linalg/sparse.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

/// Each segment between two guide points is a vector d = sum_i W_i x_i + offset, so that
///   length          L = sum |d|
///   gradient        dL/dx_i = sum W_i t,                t = d / |d|
///   second gradient d2L/dx_i dx_j = sum W_i W_j (I - t t^T) / |d|.
/// |d| has a kink at zero, where two guide points meet because a gap has closed. Below `met_length_m` (a thousandth of
/// the cable) it is replaced by the parabola that continues it smoothly (Huber), so that the points stay together.
class CablePath {
public:
    /// `points`: at least two. `rest` (3n): node positions at rest.
    CablePath(std::span<const Attachment> points, std::span<const double> rest);

    /// With `shares` (segments) all three are for the weighted length, sum of shares[k] |d_k|; default: all shares are
    /// 1.
    [[nodiscard]] double length(std::span<const double> x, std::span<const double> shares = {}) const;
    /// forces (3n) += factor * dL/dx.
    void add_gradient(std::span<const double> x, double factor, std::span<double> forces,
                      std::span<const double> shares = {}) const;
    using NodeGradient = std::pair<int, Vec3>;  ///< a node and dL with respect to its position
    /// dL/dx of all nodes that the path depends on, ascending.
    [[nodiscard]] std::vector<NodeGradient> gradient(std::span<const double> x) const;
    /// The nodes that the path depends on, ascending.
    [[nodiscard]] std::vector<int> nodes() const;
    /// values += factor * second gradient, for a pattern over free nodes (block 3) that holds cliques().
    void add_hessian(std::span<const double> x, double factor, const std::vector<int>& free_index,
                     const linalg::SymmetricPattern& pattern, std::span<double> values,
                     std::span<const double> shares = {}) const;
    /// (segments) tension in each segment as a share of that in the first (or the last, if the cable is pulled there),
    /// for a cable that slides with friction through its guide points: exp(-friction * accumulated turning angle). A
    /// negative friction is that of a cable being released. Source: Euler 1769, Eytelwein 1808.
    [[nodiscard]] std::vector<double> tension_shares(std::span<const double> x, double friction,
                                                     bool pulled_at_first) const;
    [[nodiscard]] std::size_t segment_count() const { return segments_.size(); }
    /// d_k, m; and its change as the nodes move (3n).
    [[nodiscard]] Vec3 segment_vector(std::size_t k, std::span<const double> x) const {
        return vector_of(segments_[k], x);
    }
    [[nodiscard]] Vec3 segment_motion(std::size_t k, std::span<const double> motion) const {
        return vector_of(segments_[k], motion) - segments_[k].offset;
    }
    [[nodiscard]] double met_length_m() const { return met_length_m_; }
    /// The first segment whose end points have met (index from 0), or -1.
    [[nodiscard]] int closed_segment(std::span<const double> x) const;
    void append_cliques(const std::vector<int>& free_index, linalg::Lists& cliques) const;

private:
    struct Segment {
        std::vector<int> nodes;
        std::vector<double> weights;
        Vec3 offset;
    };
    [[nodiscard]] static Vec3 vector_of(const Segment& segment, std::span<const double> x);
    std::vector<Segment> segments_;
    double met_length_m_ = 0;
};

}  // namespace pliant::sim
