#include "simulation/linearisation/damping_stiffness.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "base/core/parallel.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/linearisation/element_derivatives.hpp"
#include "simulation/material/law_parameters.hpp"
#include "simulation/material/point.hpp"
#include "simulation/material/rest_moduli.hpp"

namespace pliant::sim {
namespace {

using linalg::Matrix3;
using linalg::view;

/// Relative step of the central differences of the moduli in a constant. Their error is some 1e-10.
constexpr double step_of_constant = 1e-5;

constexpr std::size_t damped_tets_at_once = 64;

using material::RestModuli;

Matrix3 symmetric(const Matrix3& A) {
    return 0.5 * (A + A.transpose());
}

/// The stress of a velocity gradient A: P = lame (cof F : A) cof F + 2 shear F sym(F^T A), linear in A and symmetric.
class StrainRateLaw {
public:
    StrainRateLaw(const RestModuli& moduli, const Matrix3& F)
        : moduli_(moduli), F_(F), cofactor_(material::cofactor(F)) {}

    [[nodiscard]] Matrix3 stress(const Matrix3& A) const { return stress(moduli_, A); }
    /// With other moduli.
    [[nodiscard]] Matrix3 stress(const RestModuli& moduli, const Matrix3& A) const {
        return moduli.lame_Pa * dilation(A) * cofactor_ + 2 * moduli.shear_Pa * F_ * strain(A);
    }
    /// a . P for the stress P of A with other moduli.
    [[nodiscard]] double product(const RestModuli& moduli, const Matrix3& a, const Matrix3& A) const {
        return moduli.lame_Pa * dilation(a) * dilation(A) +
               2 * moduli.shear_Pa * strain(a).cwiseProduct(strain(A)).sum();
    }
    /// Change of the stress of A with F.
    [[nodiscard]] Matrix3 rate(const Matrix3& dF, const Matrix3& A) const {
        const Matrix3 change = cofactor_rate(dF);
        return moduli_.lame_Pa * (change.cwiseProduct(A).sum() * cofactor_ + dilation(A) * change) +
               2 * moduli_.shear_Pa * (dF * strain(A) + F_ * symmetric(dF.transpose() * A));
    }
    /// Gradient by F of a . P for the stress P of A.
    [[nodiscard]] Matrix3 slope(const Matrix3& a, const Matrix3& A) const {
        return moduli_.lame_Pa * (dilation(A) * cofactor_rate(a) + dilation(a) * cofactor_rate(A)) +
               2 * moduli_.shear_Pa * (a * strain(A) + A * strain(a));
    }

private:
    [[nodiscard]] Matrix3 strain(const Matrix3& A) const { return symmetric(F_.transpose() * A); }
    [[nodiscard]] double dilation(const Matrix3& A) const { return cofactor_.cwiseProduct(A).sum(); }
    /// The cofactor is a quadratic function of F; as a bilinear form in two directions its change is symmetric.
    [[nodiscard]] Matrix3 cofactor_rate(const Matrix3& dF) const {
        return material::cofactor(F_ + dF) - cofactor_ - material::cofactor(dF);
    }

    RestModuli moduli_;
    Matrix3 F_, cofactor_;
};

/// Of each law: its moduli, and how they change with each of its constants.
class LawModuli {
public:
    explicit LawModuli(const Elements& elements) {
        for (std::size_t t = 0; t < elements.tet_count(); ++t) {
            const auto material = static_cast<std::size_t>(elements.material(t));
            if (material >= of_.size()) of_.resize(material + 1);
            if (!of_[material]) of_[material] = {material::rest_moduli(elements.law(t)), rates_of(elements.law(t))};
        }
    }
    [[nodiscard]] const RestModuli& of(int material) const { return of_[static_cast<std::size_t>(material)]->moduli; }
    /// (constants of the law)
    [[nodiscard]] const std::vector<RestModuli>& rates(int material) const {
        return of_[static_cast<std::size_t>(material)]->rates;
    }

private:
    struct Entry {
        RestModuli moduli;
        std::vector<RestModuli> rates;
    };

    static std::vector<RestModuli> rates_of(const material::Law& law) {
        const std::vector<material::LawParameter> all = material::parameters(law);
        std::vector<RestModuli> rates;
        for (std::size_t c = 0; c < all.front().direction.size(); ++c) {
            const double typical = all[c].value != 0     ? std::fabs(all[c].value)
                                   : all[c].unit.empty() ? 1
                                                         : 1 / step_of_constant;
            const double step = step_of_constant * typical;
            const RestModuli more = material::rest_moduli(material::with_parameter(law, c, all[c].value + step)),
                             less = material::rest_moduli(material::with_parameter(law, c, all[c].value - step));
            rates.push_back({(more.lame_Pa - less.lame_Pa) / (2 * step), (more.shear_Pa - less.shear_Pa) / (2 * step)});
        }
        return rates;
    }

    std::vector<std::optional<Entry>> of_;
};

/// What the force depends on at an integration point.
struct DampedPoint {
    StrainRateLaw law;
    Matrix3 F;         ///< at the positions of the stiffness
    Matrix3 velocity;  ///< gradient of u
    double volume;     ///< with the factor beta
};

DampedPoint point_of(const DampedStep& step, const LawModuli& moduli, std::size_t t, int q) {
    const Matrix3 F = step.elements->deformation_gradient(t, q, view(step.place));
    return {StrainRateLaw(moduli.of(step.elements->material(t)), F), F,
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
    return DampedStep{&at.system().model().elements(), inertia->damping_place().of(inertia->start()),
                      inertia->damped_velocity(at.state().x), inertia->damping().stiffness_s};
}

void add_damping_place_product(const DampedStep& step, const Eigen::VectorXd& motion, Eigen::VectorXd& forces) {
    const LawModuli moduli(*step.elements);
    add_stresses(
        *step.elements,
        [&](std::size_t t, int q) -> Matrix3 {
            const DampedPoint at = point_of(step, moduli, t, q);
            const Matrix3 dF = step.elements->deformation_gradient(t, q, view(motion));
            return at.volume * at.law.rate(dF, at.velocity);
        },
        forces);
}

Eigen::VectorXd damping_place_weights(const DampedStep& step, const Eigen::VectorXd& weights) {
    const LawModuli moduli(*step.elements);
    Eigen::VectorXd result = Eigen::VectorXd::Zero(weights.size());
    add_stresses(
        *step.elements,
        [&](std::size_t t, int q) -> Matrix3 {
            const DampedPoint at = point_of(step, moduli, t, q);
            const Matrix3 G = step.elements->deformation_gradient(t, q, view(weights));
            return at.volume * at.law.slope(G, at.velocity);
        },
        result);
    return result;
}

void add_damping_law_force(const DampedStep& step, const Eigen::MatrixXd& direction, Eigen::VectorXd& forces) {
    const LawModuli moduli(*step.elements);
    add_stresses(
        *step.elements,
        [&](std::size_t t, int q) -> Matrix3 {
            const auto changes = direction.col(static_cast<Eigen::Index>(t));
            if (changes.isZero(0)) return Matrix3::Zero();
            const DampedPoint at = point_of(step, moduli, t, q);
            const std::vector<RestModuli>& rates = moduli.rates(step.elements->material(t));
            RestModuli change{0, 0};
            for (std::size_t c = 0; c < rates.size(); ++c) {
                change.lame_Pa += changes[static_cast<Eigen::Index>(c)] * rates[c].lame_Pa;
                change.shear_Pa += changes[static_cast<Eigen::Index>(c)] * rates[c].shear_Pa;
            }
            return at.volume * at.law.stress(change, at.velocity);
        },
        forces);
}

void add_damping_law_products(const DampedStep& step, const Eigen::VectorXd& weights, Eigen::MatrixXd& products) {
    const Elements& elements = *step.elements;
    const LawModuli moduli(elements);
    parallel_for(elements.tet_count(), damped_tets_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const std::vector<RestModuli>& rates = moduli.rates(elements.material(t));
            for (int q = 0; q < elements.points_per_tet(); ++q) {
                const DampedPoint at = point_of(step, moduli, t, q);
                const Matrix3 G = elements.deformation_gradient(t, q, view(weights));
                for (std::size_t c = 0; c < rates.size(); ++c)
                    products(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(t)) +=
                        at.volume * at.law.product(rates[c], G, at.velocity);
            }
        }
    });
}

void add_damping_rest_product(const DampedStep& step, const Eigen::VectorXd& motion, Eigen::VectorXd& forces) {
    const LawModuli moduli(*step.elements);
    add_stresses(
        *step.elements,
        [&](std::size_t t, int q) -> Matrix3 {
            const DampedPoint at = point_of(step, moduli, t, q);
            const Matrix3 L = step.elements->deformation_gradient(t, q, view(motion));
            const Matrix3 P = at.law.stress(at.velocity);
            const Matrix3 change = at.law.rate(-at.F * L, at.velocity) - at.law.stress(at.velocity * L);
            return at.volume * (L.trace() * P + change - P * L.transpose());
        },
        forces);
}

void add_damping_rest_weights(const DampedStep& step, const Eigen::VectorXd& weights, Eigen::VectorXd& result) {
    const LawModuli moduli(*step.elements);
    add_stresses(
        *step.elements,
        [&](std::size_t t, int q) -> Matrix3 {
            const DampedPoint at = point_of(step, moduli, t, q);
            const Matrix3 G = step.elements->deformation_gradient(t, q, view(weights));
            const Matrix3 P = at.law.stress(at.velocity);
            return at.volume *
                   (P.cwiseProduct(G).sum() * Matrix3::Identity() - at.F.transpose() * at.law.slope(G, at.velocity) -
                    G.transpose() * P - at.velocity.transpose() * at.law.stress(G));
        },
        result);
}

}  // namespace pliant::sim
