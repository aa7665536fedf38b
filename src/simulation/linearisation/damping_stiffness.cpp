#include "simulation/linearisation/damping_stiffness.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "base/core/parallel.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/linearisation/element_derivatives.hpp"
#include "simulation/material/law_parameters.hpp"

namespace pliant::sim {
namespace {

using linalg::Matrix3;
using linalg::Matrix9;
using linalg::view;
using Vector9 = Eigen::Matrix<double, 9, 1>;

/// Steps of the central differences of the tangent: in F, and relative in a constant. Their error is some 1e-10.
constexpr double step_of_F = 1e-5, step_of_constant = 1e-5;

constexpr std::size_t damped_tets_at_once = 64;

Vector9 stacked(const Matrix3& A) {
    return Eigen::Map<const Vector9>(A.data());
}

Matrix3 unstacked(const Vector9& a) {
    return Eigen::Map<const Matrix3>(a.data());
}

Matrix9 symmetric_tangent(const material::Law& law, const Matrix3& F) {
    const Matrix9 H = material::tangent(law, F);
    return 0.5 * (H + H.transpose());
}

/// dH/dF along `direction`.
Matrix9 tangent_rate(const material::Law& law, const Matrix3& F, const Matrix3& direction) {
    const double length = direction.norm();
    if (!(length > 0)) return Matrix9::Zero();
    const Matrix3 step = step_of_F / length * direction;
    return length / (2 * step_of_F) * (symmetric_tangent(law, F + step) - symmetric_tangent(law, F - step));
}

/// The tangent H at a point, its projection to a positive semi-definite one, and the derivative of the projection.
class ProjectedTangent {
public:
    ProjectedTangent(const material::Law& law, const Matrix3& F) : law_(law), F_(F), H_(symmetric_tangent(law, F)) {
        if (H_.llt().info() == Eigen::Success) return;
        is_clamped_ = true;
        const Eigen::SelfAdjointEigenSolver<Matrix9> eigen(H_);
        vectors_ = eigen.eigenvectors();
        const Vector9 values = eigen.eigenvalues();
        for (int i = 0; i < 9; ++i) {
            for (int j = 0; j < 9; ++j) {
                const double high = std::max(values[i], values[j]), low = std::min(values[i], values[j]);
                shares_(i, j) = low >= 0 ? 1 : high <= 0 ? 0 : high / (high - low);
            }
        }
        H_ = vectors_ * values.cwiseMax(0.0).asDiagonal() * vectors_.transpose();
    }

    [[nodiscard]] const Matrix9& value() const { return H_; }
    /// Derivative of the projection along a symmetric dH; as an operator on matrices it is symmetric (Daleckii and
    /// Krein 1965).
    [[nodiscard]] Matrix9 rate(const Matrix9& dH) const {
        if (!is_clamped_) return dH;
        const Matrix9 inside = vectors_.transpose() * dH * vectors_;
        return vectors_ * shares_.cwiseProduct(inside) * vectors_.transpose();
    }
    /// The matrix whose product with dH is the change of a . H b.
    [[nodiscard]] Matrix9 weights(const Vector9& a, const Vector9& b) const {
        return rate(0.5 * (a * b.transpose() + b * a.transpose()));
    }
    /// Gradient of a . H b by F.
    [[nodiscard]] Matrix3 slope(const Vector9& a, const Vector9& b) const {
        // Third derivatives of an energy are symmetric.
        if (!is_clamped_ && material::has_energy(law_)) return unstacked(tangent_rate(law_, F_, unstacked(b)) * a);
        const Matrix9 by = weights(a, b);
        Matrix3 slope;
        for (Eigen::Index k = 0; k < 9; ++k)
            slope.data()[k] = by.cwiseProduct(tangent_rate(law_, F_, unstacked(Vector9::Unit(k)))).sum();
        return slope;
    }

private:
    const material::Law& law_;
    Matrix3 F_;
    Matrix9 H_, vectors_, shares_;
    bool is_clamped_ = false;
};

/// For each constant of a law: the law with a little more and a little less of it, and the difference.
struct Neighbours {
    material::Law more, less;
    double apart = 0;
};

std::vector<Neighbours> neighbours_of(const material::Law& law) {
    const std::vector<material::LawParameter> all = material::parameters(law);
    std::vector<Neighbours> neighbours;
    for (std::size_t c = 0; c < all.front().direction.size(); ++c) {
        const double typical = all[c].value != 0     ? std::fabs(all[c].value)
                               : all[c].unit.empty() ? 1
                                                     : 1 / step_of_constant;
        const double step = step_of_constant * typical;
        neighbours.push_back({material::with_parameter(law, c, all[c].value + step),
                              material::with_parameter(law, c, all[c].value - step), 2 * step});
    }
    return neighbours;
}

/// Of the law of each material, computed when first asked for.
class LawNeighbours {
public:
    explicit LawNeighbours(const Elements& elements) {
        for (std::size_t t = 0; t < elements.tet_count(); ++t) {
            const auto material = static_cast<std::size_t>(elements.material(t));
            if (material >= of_.size()) of_.resize(material + 1);
            if (of_[material].empty()) of_[material] = neighbours_of(elements.law(t));
        }
    }
    [[nodiscard]] const std::vector<Neighbours>& of(int material) const {
        return of_[static_cast<std::size_t>(material)];
    }

private:
    std::vector<std::vector<Neighbours>> of_;
};

Matrix9 tangent_rate(const Neighbours& by, const Matrix3& F) {
    return (symmetric_tangent(by.more, F) - symmetric_tangent(by.less, F)) / by.apart;
}

/// What the force depends on at an integration point.
struct DampedPoint {
    Matrix3 F;         ///< at the start
    Matrix3 velocity;  ///< gradient of u
    double volume;     ///< with the factor beta
};

DampedPoint point_of(const DampedStep& step, std::size_t t, int q) {
    return {step.elements->deformation_gradient(t, q, view(step.start)),
            step.elements->deformation_gradient(t, q, view(step.velocity)),
            step.factor * step.elements->point_volume(t, q)};
}

/// result (3n) += P grad N_a over all points, with P from `stress_of(tet, point)`: computed in parallel, added in
/// order.
template <class StressOf>
void add_stresses(const Elements& elements, const StressOf& stress_of, Eigen::VectorXd& result) {
    const auto points = static_cast<std::size_t>(elements.points_per_tet());
    std::vector<Matrix3> stresses(elements.tet_count() * points);
    parallel_for(elements.tet_count(), damped_tets_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            for (std::size_t q = 0; q < points; ++q) stresses[t * points + q] = stress_of(t, static_cast<int>(q));
        }
    });
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        for (std::size_t q = 0; q < points; ++q) {
            for (int a = 0; a < static_cast<int>(elements.nodes_per_tet()); ++a)
                result.segment<3>(3 * elements.node_of(t, a)) +=
                    stresses[t * points + q] * linalg::vector(elements.shape_gradient(t, static_cast<int>(q), a));
        }
    }
}

}  // namespace

std::optional<DampedStep> damped_step(const Linearisation& at) {
    const auto& inertia = at.controls().inertia;
    if (!inertia || inertia->is_tether() || !(inertia->damping().stiffness_s > 0)) return std::nullopt;
    return DampedStep{&at.system().model().elements(), inertia->start().x, inertia->damped_velocity(at.state().x),
                      inertia->damping().stiffness_s};
}

void add_damping_start_product(const DampedStep& step, const Eigen::VectorXd& motion, Eigen::VectorXd& forces) {
    add_stresses(
        *step.elements,
        [&](std::size_t t, int q) -> Matrix3 {
            const DampedPoint at = point_of(step, t, q);
            const material::Law& law = step.elements->law(t);
            const Matrix9 dH = tangent_rate(law, at.F, step.elements->deformation_gradient(t, q, view(motion)));
            return at.volume * unstacked(ProjectedTangent(law, at.F).rate(dH) * stacked(at.velocity));
        },
        forces);
}

Eigen::VectorXd damping_start_weights(const DampedStep& step, const Eigen::VectorXd& weights) {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(weights.size());
    add_stresses(
        *step.elements,
        [&](std::size_t t, int q) -> Matrix3 {
            const DampedPoint at = point_of(step, t, q);
            const Matrix3 G = step.elements->deformation_gradient(t, q, view(weights));
            const ProjectedTangent tangent(step.elements->law(t), at.F);
            return at.volume * tangent.slope(stacked(G), stacked(at.velocity));
        },
        result);
    return result;
}

void add_damping_law_force(const DampedStep& step, const Eigen::MatrixXd& direction, Eigen::VectorXd& forces) {
    const LawNeighbours neighbours(*step.elements);
    add_stresses(
        *step.elements,
        [&](std::size_t t, int q) -> Matrix3 {
            const auto changes = direction.col(static_cast<Eigen::Index>(t));
            if (changes.isZero(0)) return Matrix3::Zero();
            const DampedPoint at = point_of(step, t, q);
            const auto& constants = neighbours.of(step.elements->material(t));
            Matrix9 dH = Matrix9::Zero();
            for (std::size_t c = 0; c < constants.size(); ++c)
                dH += changes[static_cast<Eigen::Index>(c)] * tangent_rate(constants[c], at.F);
            const ProjectedTangent tangent(step.elements->law(t), at.F);
            return at.volume * unstacked(tangent.rate(dH) * stacked(at.velocity));
        },
        forces);
}

void add_damping_law_products(const DampedStep& step, const Eigen::VectorXd& weights, Eigen::MatrixXd& products) {
    const Elements& elements = *step.elements;
    const LawNeighbours neighbours(elements);
    parallel_for(elements.tet_count(), damped_tets_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const auto& constants = neighbours.of(elements.material(t));
            for (int q = 0; q < elements.points_per_tet(); ++q) {
                const DampedPoint at = point_of(step, t, q);
                const Matrix3 G = elements.deformation_gradient(t, q, view(weights));
                const Matrix9 by = ProjectedTangent(elements.law(t), at.F).weights(stacked(G), stacked(at.velocity));
                for (std::size_t c = 0; c < constants.size(); ++c)
                    products(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(t)) +=
                        at.volume * by.cwiseProduct(tangent_rate(constants[c], at.F)).sum();
            }
        }
    });
}

void add_damping_rest_product(const DampedStep& step, const Eigen::VectorXd& motion, Eigen::VectorXd& forces) {
    add_stresses(
        *step.elements,
        [&](std::size_t t, int q) -> Matrix3 {
            const DampedPoint at = point_of(step, t, q);
            const material::Law& law = step.elements->law(t);
            const Matrix3 L = step.elements->deformation_gradient(t, q, view(motion));
            const ProjectedTangent tangent(law, at.F);
            const Matrix3 P = unstacked(tangent.value() * stacked(at.velocity));
            const Vector9 change = tangent.rate(tangent_rate(law, at.F, -at.F * L)) * stacked(at.velocity) -
                                   tangent.value() * stacked(at.velocity * L);
            return at.volume * (L.trace() * P + unstacked(change) - P * L.transpose());
        },
        forces);
}

void add_damping_rest_weights(const DampedStep& step, const Eigen::VectorXd& weights, Eigen::VectorXd& result) {
    add_stresses(
        *step.elements,
        [&](std::size_t t, int q) -> Matrix3 {
            const DampedPoint at = point_of(step, t, q);
            const Matrix3 G = step.elements->deformation_gradient(t, q, view(weights));
            const ProjectedTangent tangent(step.elements->law(t), at.F);
            const Matrix3 P = unstacked(tangent.value() * stacked(at.velocity));
            const Matrix3 M = unstacked(tangent.value() * stacked(G));
            const Matrix3 slope = tangent.slope(stacked(G), stacked(at.velocity));
            return at.volume * (P.cwiseProduct(G).sum() * Matrix3::Identity() - at.F.transpose() * slope -
                                G.transpose() * P - at.velocity.transpose() * M);
        },
        result);
}

}  // namespace pliant::sim
