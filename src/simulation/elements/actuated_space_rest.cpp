// Derivatives of gap elements with respect to the rest positions and their weights.
#include <algorithm>

#include "base/linalg/vectors.hpp"
#include "simulation/elements/actuated_space.hpp"
#include "simulation/elements/elements.hpp"

namespace pliant::sim {
namespace {

using linalg::Matrix3;
using linalg::Vector3;

/// At one integration point: F, the gradient of the rest motion, and their effect on the cable's direction d.
struct AtPoint {
    Matrix3 F;
    Vector3 direction, along;  ///< d, and t = F d / |F d|
    double length = 0;         ///< |F d|
};

AtPoint at_point(const Elements& elements, std::size_t tet, int q, const Vec3& direction, std::span<const double> x) {
    AtPoint at{elements.deformation_gradient(tet, q, x), linalg::vector(direction), {}, 0};
    at.along = at.F * at.direction;
    at.length = at.along.norm();
    at.along /= at.length;
    return at;
}

}  // namespace

std::vector<double> GapElements::volumes(const Elements& elements) const {
    std::vector<double> of_gap(directions_.size(), 0.0);
    for (const Point& p : points_) of_gap[p.gap] += elements.point_volume(p.tet, p.point);
    return of_gap;
}

GapElements::Growths GapElements::growths(const Elements& elements, std::span<const double> motion) const {
    const std::vector<double> volume = volumes(elements);
    Growths growths{0, std::vector<double>(volume.size(), 0.0)};
    double whole = 0;
    for (const Point& p : points_)
        growths.of_gap[p.gap] +=
            elements.point_volume(p.tet, p.point) * elements.deformation_gradient(p.tet, p.point, motion).trace();
    for (std::size_t g = 0; g < volume.size(); ++g) {
        growths.whole += growths.of_gap[g];
        growths.of_gap[g] /= volume[g];
        whole += volume[g];
    }
    growths.whole /= whole;
    return growths;
}

/// f_a = sum k (l - s) (grad N_a . d) t, with k in proportion to V V_p / V_gap and m / c = 1 - s to 1 / V: V the volume
/// of all gaps, V_p that of an integration point.
void GapElements::add_rest_product(const Elements& elements, std::span<const double> x, double m,
                                   std::span<const double> motion, std::span<double> forces) const {
    const Growths grown = growths(elements, motion);
    const double s = scale(m);
    for (std::size_t k = 0; k < count(); ++k) {
        const Point& p = points_[k];
        const AtPoint at = at_point(elements, p.tet, p.point, directions_[p.gap], x);
        const Matrix3 L = elements.deformation_gradient(p.tet, p.point, motion);
        const Vector3 moved = L * at.direction, v = -at.F * moved;
        const double longer = at.along.dot(v), pull = stiffness_J_[k] * (at.length - s);
        const Vector3 change = pull * (grown.whole + L.trace() - grown.of_gap[p.gap]) * at.along +
                               stiffness_J_[k] * (longer - (1 - s) * grown.whole) * at.along +
                               pull / at.length * (v - longer * at.along);
        for (std::size_t a = 0; a < width_; ++a) {
            const Vector3 slope = linalg::vector(elements.shape_gradient(p.tet, p.point, static_cast<int>(a)));
            const Vector3 force = slope.dot(at.direction) * change - slope.dot(moved) * pull * at.along;
            Eigen::Map<Vector3>(forces.data() + 3 * static_cast<std::size_t>(nodes_[k * width_ + a])) += force;
        }
    }
}

void GapElements::add_rest_weights(const Elements& elements, std::span<const double> x, double m,
                                   std::span<const double> weights, std::span<double> result) const {
    const double s = scale(m);
    std::vector<double> of_gap(directions_.size(), 0.0);
    double of_all = 0;
    std::vector<Matrix3> by_motion;
    for (std::size_t k = 0; k < count(); ++k) {
        const Point& p = points_[k];
        const AtPoint at = at_point(elements, p.tet, p.point, directions_[p.gap], x);
        const Matrix3 G = elements.deformation_gradient(p.tet, p.point, weights);
        const Vector3 u = G * at.direction;
        const double ut = u.dot(at.along), pull = stiffness_J_[k] * (at.length - s);
        const Vector3 by_v = (stiffness_J_[k] - pull / at.length) * ut * at.along + pull / at.length * u;
        by_motion.push_back(pull * ut * Matrix3::Identity() -
                            (at.F.transpose() * by_v + pull * G.transpose() * at.along) * at.direction.transpose());
        of_gap[p.gap] -= pull * ut;
        of_all += pull * ut - stiffness_J_[k] * (1 - s) * ut;
    }
    spread(elements, by_motion, of_all, of_gap, result);
}

void GapElements::spread(const Elements& elements, const std::vector<Matrix3>& by_gradient, double by_whole,
                         const std::vector<double>& by_gap, std::span<double> result) const {
    const std::vector<double> volume = volumes(elements);
    double whole = 0;
    for (const double v : volume) whole += v;
    for (std::size_t k = 0; k < count(); ++k) {
        const Point& p = points_[k];
        const double share = elements.point_volume(p.tet, p.point);
        const Matrix3 Y =
            by_gradient[k] + share * (by_gap[p.gap] / volume[p.gap] + by_whole / whole) * Matrix3::Identity();
        for (std::size_t a = 0; a < width_; ++a)
            Eigen::Map<Vector3>(result.data() + 3 * static_cast<std::size_t>(nodes_[k * width_ + a])) +=
                Y * linalg::vector(elements.shape_gradient(p.tet, p.point, static_cast<int>(a)));
    }
}

double GapElements::tension_by_weight(std::span<const double> x, std::size_t gap_number) const {
    const std::size_t gap = place_of(gap_number);
    double sum = 0;
    for (std::size_t k = 0; k < count(); ++k)
        sum += points_[k].gap == gap ? stiffness_J_[k] * (along(k, x).length - 1) : 0;
    return sum / gap_weights_Pa_[gap] / length_m_;
}

/// Gradient of sum k l / L - c + m.
void GapElements::add_tension_rest_gradient(const Elements& elements, std::span<const double> x, double factor,
                                            std::span<double> result) const {
    std::vector<double> of_gap(directions_.size(), 0.0);
    double of_all = -factor * stiffness_N_;
    std::vector<Matrix3> by_motion;
    for (std::size_t k = 0; k < count(); ++k) {
        const Point& p = points_[k];
        const AtPoint at = at_point(elements, p.tet, p.point, directions_[p.gap], x);
        const double stiffness = factor * stiffness_J_[k] / length_m_;
        by_motion.push_back(stiffness *
                            (at.length * Matrix3::Identity() - at.F.transpose() * at.along * at.direction.transpose()));
        of_gap[p.gap] -= stiffness * at.length;
        of_all += stiffness * at.length;
    }
    spread(elements, by_motion, of_all, of_gap, result);
}

std::size_t GapElements::place_of(std::size_t gap_number) const {
    return static_cast<std::size_t>(std::ranges::find(numbers_, gap_number) - numbers_.begin());
}

bool GapElements::has(std::size_t gap_number) const {
    return std::ranges::find(numbers_, gap_number) != numbers_.end();
}

void GapElements::add_weight_force(std::span<const double> x, double m, std::size_t gap_number,
                                   std::span<double> forces) const {
    const std::size_t gap = place_of(gap_number);
    double share = 0;  // share of c that comes from this gap
    for (std::size_t k = 0; k < count(); ++k) share += points_[k].gap == gap ? stiffness_J_[k] : 0;
    share /= stiffness_N_ * length_m_;
    const double s = scale(m), weight = gap_weights_Pa_[gap];
    for (std::size_t k = 0; k < count(); ++k) {
        const Along now = along(k, x);
        const double own = points_[k].gap == gap ? now.length - s : 0;
        const Vec3 pull = (stiffness_J_[k] * (own - (1 - s) * share) / weight / now.length) * now.vector;
        for (std::size_t a = k * width_; a < (k + 1) * width_; ++a) {
            double* f = forces.data() + 3 * static_cast<std::size_t>(nodes_[a]);
            for (std::size_t i = 0; i < 3; ++i) f[i] += weights_[a] * pull[i];
        }
    }
}

}  // namespace pliant::sim
