// The force and stiffness of an elastic spring along a path of points: a helical spring between two of them, a rubber
// band through several.
#pragma once

#include <span>
#include <vector>

#include "base/linalg/sparse.hpp"
#include "simulation/actuators/cable_path.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

/// E = k/2 (L - L0)^2 with path length L (m), stiffness k (N/m) and free length L0; E = 0 if a spring that only pulls
/// is shorter than L0. Gradient: k (L - L0) dL/dx. Second gradient: k dL/dx dL/dx^T + k (L - L0) d2L/dx2.
class SpringPath {
public:
    /// `rest` (3n): node positions at rest. Precondition: the spring passed Model::create.
    SpringPath(const Spring& spring, std::span<const double> rest);

    [[nodiscard]] double length(std::span<const double> x) const { return path_.length(x); }
    /// Force, N; positive if it pulls.
    [[nodiscard]] double force(std::span<const double> x) const;
    [[nodiscard]] double energy(std::span<const double> x) const;
    /// forces (3n) += gradient of the energy.
    void add_gradient(std::span<const double> x, std::span<double> forces) const;
    /// forces (3n) += factor * dL/dx.
    void add_length_gradient(std::span<const double> x, double factor, std::span<double> forces) const {
        path_.add_gradient(x, factor, forces);
    }
    [[nodiscard]] double free_length() const { return free_length_m_; }
    /// For a pattern over free nodes (block 3) that holds the clique. `project` leaves out the part that makes the
    /// second gradient of a compressed spring indefinite.
    void add_hessian(std::span<const double> x, const std::vector<int>& free_index,
                     const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const;
    void append_clique(const std::vector<int>& free_index, linalg::Lists& cliques) const;

private:
    CablePath path_;
    double stiffness_N_m_;
    double free_length_m_;
    bool only_pulls_;
};

}  // namespace pliant::sim
