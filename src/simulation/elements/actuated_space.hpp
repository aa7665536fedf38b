// The thesis' actuators: meshed empty space whose target shape an actuator scales (T3.5, T3.6). docs/theory.md, "The
// thesis' actuators".
#pragma once

#include <span>
#include <vector>

#include "base/core/vec3.hpp"
#include "base/linalg/small.hpp"
#include "base/linalg/sparse.hpp"
#include "robot/description/law.hpp"
#include "simulation/parts/robot_names.hpp"

namespace pliant::sim {

class Elements;

/// Resistance of meshed space to changes of shape, relative to the Young's modulus of the softest body: an element of
/// air or of a gap may shear, rotate and bend almost freely, only its measure matters.
inline constexpr double space_shape_share = 1e-3;

/// psi = mu/2 (J^(-2/3) tr F^T F - 3) + K/2 (J - 1)^2 with K = weight * softest_Pa and nearly zero mu. Under pressure p
/// a single element takes any shape of e = 1 + p/K times its volume: the target of T3.6.
[[nodiscard]] material::NeoHookean air_law(double softest_Pa, double weight);
/// Resistance of a gap element in all directions apart from its width: nearly zero.
[[nodiscard]] material::NeoHookean gap_law(double softest_Pa);

/// The elements of all gaps that one cable passes (T3.5). With the unit vector d along the cable, an element is drawn
/// towards shapes that are s times as long along d, and may shear and rotate freely:
///   E = sum k/2 (l - s)^2,   l = |F d|,   k = weight * volume
/// s is the same for all of them. It is expressed by a tension m >= 0 that closes them,
///   m = c (1 - s),   c = sum k / L,   E = sum k/2 (l - 1)^2 + m M + (a function of m alone),   M = sum k l / c
/// with L the rest length of the cable in the gaps, so that M is a mean length and equals L at rest.
class GapElements {
public:
    /// A gap and how the cable passes it. Its tets are those that this cable drives.
    struct Gap {
        std::vector<std::size_t> tets;
        Vec3 direction;          ///< of length 1
        double length_m = 0;     ///< above 0
        double weight_Pa = 0;    ///< above 0
        std::size_t number = 0;  ///< index in the caller's list
    };
    /// At least one gap with a tet.
    GapElements(const Elements& elements, std::span<const Gap> gaps);

    /// Energy E at s = 1, J.
    [[nodiscard]] double energy(std::span<const double> x) const;
    /// forces (3n) += dE/dx at s = 1.
    void add_gradient(std::span<const double> x, std::span<double> forces) const;
    /// forces (3n) += factor * dM/dx.
    void add_pull(std::span<const double> x, double factor, std::span<double> forces) const;
    /// values += second gradient of E at m, for a pattern over free nodes (block 3) of the elements. With `project`
    /// every point adds the nearest positive semi-definite matrix.
    void add_hessian(std::span<const double> x, double m, const std::vector<int>& free_index,
                     const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const;

    /// values += k G^T G of the gradients along d, one number for each pair of a pattern of block 1: added to the
    /// weighted Laplacian so that it is no softer than the elements.
    void add_laplacian(const std::vector<int>& free_index, const linalg::SymmetricPattern& pattern,
                       std::span<double> values) const;

    /// s at the multiplier m.
    [[nodiscard]] double scale(double m) const { return 1 - m / stiffness_N_; }
    /// The part of m that closes the gaps, N, beyond shortening their elements: c (M/L - s).
    [[nodiscard]] double tension(std::span<const double> x, double m) const;
    /// Derivatives of the tension: c / L, N/m, with respect to M; with respect to weight_Pa of a gap, m^2; and with
    /// respect to the rest positions, result (3n) += factor * derivative. Held fixed is what add_rest_product() holds
    /// fixed.
    [[nodiscard]] double tension_rate() const { return stiffness_N_ / length_m_; }
    [[nodiscard]] double tension_by_weight(std::span<const double> x, std::size_t gap_number) const;
    void add_tension_rest_gradient(const Elements& elements, std::span<const double> x, double factor,
                                   std::span<double> result) const;

    /// forces (3n) += the change of the gradient of E at m with a motion (3n) of the rest positions, at fixed d and
    /// fixed lengths of the cable in the gaps; and result (3n) += its transpose times `weights` (3n). `elements`: those
    /// that it was made from.
    void add_rest_product(const Elements& elements, std::span<const double> x, double m, std::span<const double> motion,
                          std::span<double> forces) const;
    void add_rest_weights(const Elements& elements, std::span<const double> x, double m,
                          std::span<const double> weights, std::span<double> result) const;
    [[nodiscard]] bool has(std::size_t gap_number) const;
    /// forces (3n) += derivative of the same gradient with respect to weight_Pa of a gap, N/Pa.
    void add_weight_force(std::span<const double> x, double m, std::size_t gap_number, std::span<double> forces) const;

private:
    /// F d at an integration point, and its length.
    struct Along {
        Vec3 vector;
        double length = 0;
    };
    [[nodiscard]] std::size_t count() const { return stiffness_J_.size(); }
    [[nodiscard]] Along along(std::size_t point, std::span<const double> x) const;
    /// forces += factor_of(l) * k * dl/dx over the points.
    template <class FactorOf>
    void add_along(std::span<const double> x, std::span<double> forces, const FactorOf& factor_of) const;

    std::size_t width_ = 0;            ///< nodes of a tet
    std::vector<int> nodes_;           ///< (points, width)
    std::vector<double> weights_;      ///< (points, width) grad N_a . d: F d is the sum of these times the positions
    std::vector<double> stiffness_J_;  ///< (points) k
    struct Point {
        std::size_t tet = 0;
        int point = 0;
        std::size_t gap = 0;
    };
    std::vector<Point> points_;           ///< (points) tet and integration point
    std::vector<Vec3> directions_;        ///< (gaps) d
    std::vector<double> gap_weights_Pa_;  ///< (gaps)
    std::vector<std::size_t> numbers_;    ///< (gaps)
    /// Relative changes of the rest volumes.
    struct Growths {
        double whole = 0;
        std::vector<double> of_gap;
    };
    [[nodiscard]] Growths growths(const Elements& elements, std::span<const double> motion) const;
    [[nodiscard]] std::vector<double> volumes(const Elements& elements) const;
    [[nodiscard]] std::size_t place_of(std::size_t gap_number) const;
    /// result (3n) += the transpose of the effect of a motion's gradients L: `by_gradient` (points) with respect to L,
    /// and the derivatives with respect to the growth of all gaps together and of each (gaps).
    void spread(const Elements& elements, const std::vector<linalg::Matrix3>& by_gradient, double by_whole,
                const std::vector<double>& by_gap, std::span<double> result) const;
    double stiffness_N_ = 0;  ///< c
    double length_m_ = 0;     ///< L
};

}  // namespace pliant::sim
