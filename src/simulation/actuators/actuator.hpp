// Actuators are driven by geometry: the length of a cable, the volume of a chamber. Each has a measure g, a function of
// the node positions, and a multiplier m that puts the force -m dg/dx on the nodes: m is the tension of a cable and
// minus the pressure of a chamber. Where a cable acts through gap elements, these put the force on the nodes instead.
#pragma once

#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "simulation/actuators/cable_path.hpp"
#include "simulation/actuators/chamber_surface.hpp"
#include "simulation/elements/actuated_space.hpp"

namespace pliant::sim {

class Actuator {
public:
    Actuator(CablePath path, std::span<const double> rest, std::optional<GapElements> gaps = std::nullopt);
    Actuator(ChamberSurface surface, std::span<const double> rest);

    /// The measure, m or m^3, at positions x and at rest. `shares` (segments of a cable) as in CablePath; chambers have
    /// none.
    [[nodiscard]] double measure(std::span<const double> x, std::span<const double> shares = {}) const;
    [[nodiscard]] double rest_measure() const { return rest_measure_; }
    /// True for a cable: it can only pull (m >= 0) and may be shorter than prescribed. Air and gap elements pull and
    /// push.
    [[nodiscard]] bool only_pulls() const { return std::holds_alternative<CablePath>(geometry_) && !gaps_; }
    /// The gap elements that a cable acts through; null if there are none.
    [[nodiscard]] const GapElements* gaps() const { return gaps_ ? &*gaps_ : nullptr; }

    /// forces (3n) += factor * dg/dx.
    void add_measure_gradient(std::span<const double> x, double factor, std::span<double> forces,
                              std::span<const double> shares = {}) const;
    /// forces (3n) += factor * (force per unit m): dg/dx, except for gap elements and at the mouths of chambers.
    void add_gradient(std::span<const double> x, double factor, std::span<double> forces,
                      std::span<const double> shares = {}) const;
    /// values += the derivative of that force at m = factor (with the elastic energy of gap elements), for a pattern
    /// over free nodes (block 3) that holds the cliques. With `project` the addition is positive semi-definite (that of
    /// a pulling cable always is).
    void add_hessian(std::span<const double> x, double factor, const std::vector<int>& free_index,
                     const linalg::SymmetricPattern& pattern, std::span<double> values, bool project,
                     std::span<const double> shares = {}) const;
    /// result (3n) += factor * (skew part of the derivative of the force) * v. Only a pressure patch and a chamber with
    /// mouths have such a part, at the nodes of their rims: their force is not the gradient of g.
    void apply_skew(std::span<const double> x, double factor, std::span<const double> v,
                    std::span<double> result) const;
    /// The same part as a matrix: adds factor * S, S^T = -S, blocks at and below the diagonal of a pattern of block 3
    /// that holds the cliques; `index` (n) of each node in it, or -1.
    void add_skew(std::span<const double> x, double factor, const std::vector<int>& index,
                  const linalg::SymmetricPattern& pattern, std::span<double> values) const;
    void append_cliques(const std::vector<int>& free_index, linalg::Lists& cliques) const;

    [[nodiscard]] bool has_mouths() const {
        const auto* surface = std::get_if<ChamberSurface>(&geometry_);
        return surface != nullptr && surface->has_mouths();
    }
    [[nodiscard]] const CablePath& cable() const { return std::get<CablePath>(geometry_); }

private:
    std::variant<CablePath, ChamberSurface> geometry_;
    std::optional<GapElements> gaps_;
    double rest_measure_;
};

/// What drives an actuator at one instant.
struct Drive {
    enum class Kind {
        measure,     ///< g = value (for a cable: g <= value)
        multiplier,  ///< m = value
        gas          ///< a sealed chamber: (-m + p_ambient) g = value, in J
    };
    Kind kind = Kind::measure;
    double value = 0;
};

}  // namespace pliant::sim
