// Derivatives of the smoothing of cable and spring segments whose ends have met. Such a segment is a parabola below
// CablePath::met_length_m(), which depends on the rest length of the path, so changes of the rest shape affect forces
// and lengths through it.
#pragma once

#include <span>
#include <vector>

#include "simulation/actuators/cable_path.hpp"

namespace pliant::sim {

/// Derivatives of the length of a path and of its gradient with respect to the met length; both are zero as long as no
/// ends have met.
class MetSegments {
public:
    /// At node positions `x` (3n), with the shares (segments) of CablePath; both must outlive it.
    MetSegments(const CablePath& path, std::span<const double> x, std::span<const double> shares = {});

    [[nodiscard]] bool any() const { return any_; }
    /// d(length) / d(met length), dimensionless.
    [[nodiscard]] double length_rate() const { return length_rate_; }
    /// forces (3n) += factor * d(dL/dx) / d(met length).
    void add_gradient_rate(double factor, std::span<double> forces) const;

private:
    const CablePath& path_;
    std::span<const double> x_;
    std::vector<double> rates_;  ///< (segments) of the factor of a segment's vector in the gradient, times l
    double length_rate_ = 0;
    bool any_ = false;
};

/// (segments) d(met length) / d(length of each segment at rest). `rest`: (3n).
[[nodiscard]] std::vector<double> met_length_rates(const CablePath& path, std::span<const double> rest);

/// by_rest (3n) += factor * d(met length) / d(rest positions).
void add_met_length_gradient(const CablePath& path, std::span<const double> rest, double factor,
                             std::span<double> by_rest);

}  // namespace pliant::sim
