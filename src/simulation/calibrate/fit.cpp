#include "simulation/calibrate/fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/NonLinearOptimization>

#include "base/core/text.hpp"
#include "base/linalg/dense.hpp"
#include "simulation/material/response.hpp"

namespace pliant::calibrate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Eigen::Map<const VectorXd> map(const std::vector<double>& values) {
    return {values.data(), static_cast<Index>(values.size())};
}

/// Derivative of the nominal stress with respect to each constant, for laws that are linear in them.
MatrixXd linear_design(FitLaw law, const std::vector<double>& stretch) {
    const Index columns = law == FitLaw::neo_hookean ? 1 : (law == FitLaw::mooney_rivlin ? 2 : 3);
    MatrixXd A(static_cast<Index>(stretch.size()), columns);
    for (Index i = 0; i < A.rows(); ++i) {
        const double l = stretch[static_cast<std::size_t>(i)];
        const double g = l - 1 / (l * l);
        const double x = l * l + 2 / l - 3;
        if (law == FitLaw::neo_hookean) A.row(i) << g / 3;  // for E = 3 mu
        if (law == FitLaw::mooney_rivlin) A.row(i) << 2 * g, 2 * g / l;
        if (law == FitLaw::yeoh) A.row(i) << 2 * g, 4 * g * x, 6 * g * x * x;
    }
    return A;
}

/// (2 / alpha) (l^(alpha-1) - l^(-alpha/2-1)), and its derivative with respect to alpha. The limit at alpha = 0 is not
/// needed: iterations do not hit it exactly.
double ogden_shape(double l, double a) {
    return 2 / a * (std::pow(l, a - 1) - std::pow(l, -a / 2 - 1));
}
double ogden_shape_slope(double l, double a) {
    const double part = std::log(l) * (std::pow(l, a - 1) + 0.5 * std::pow(l, -a / 2 - 1));
    return 2 / a * part - ogden_shape(l, a) / a;
}

/// Residuals of Ogden's law for Eigen's Levenberg-Marquardt; unknowns (mu_1, alpha_1, mu_2, ...), mu over `scale`.
struct OgdenResiduals {
    using Scalar = double;
    using InputType = VectorXd;
    using ValueType = VectorXd;
    using JacobianType = MatrixXd;
    enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

    const TensileTest& test;
    int terms;
    double scale;

    [[nodiscard]] int inputs() const { return 2 * terms; }
    [[nodiscard]] int values() const { return static_cast<int>(test.stretch.size()); }
    int operator()(const VectorXd& x, VectorXd& residual) const {
        for (Index i = 0; i < values(); ++i) {
            const auto row = static_cast<std::size_t>(i);
            residual[i] = -test.stress_Pa[row] / scale;
            for (int k = 0; k < terms; ++k) residual[i] += x[2 * k] * ogden_shape(test.stretch[row], x[2 * k + 1]);
        }
        return 0;
    }
    int df(const VectorXd& x, MatrixXd& J) const {
        for (Index i = 0; i < values(); ++i) {
            const double l = test.stretch[static_cast<std::size_t>(i)];
            for (int k = 0; k < terms; ++k) {
                J(i, 2 * k) = ogden_shape(l, x[2 * k + 1]);
                J(i, 2 * k + 1) = x[2 * k] * ogden_shape_slope(l, x[2 * k + 1]);
            }
        }
        return 0;
    }
};

/// Starting exponents: several pairs of small and large ones, of both signs. The best fit is used.
std::vector<std::vector<double>> ogden_starts(int terms) {
    if (terms == 1) return {{1.3}, {2}, {3}, {5}, {10}, {-2}};
    if (terms == 2) return {{1.3, 5}, {2, -2}, {2, 6}, {3, -3}, {1, 10}, {1.5, 3}};
    return {{1.3, 5, -2}, {2, 6, -3}, {1, 3, 10}, {2, 4, -1}};
}

/// At fixed exponents the mu are a linear fit.
VectorXd ogden_start(const TensileTest& test, const std::vector<double>& alpha, double scale) {
    const auto terms = static_cast<Index>(alpha.size());
    MatrixXd A(static_cast<Index>(test.stretch.size()), terms);
    for (Index i = 0; i < A.rows(); ++i) {
        for (Index k = 0; k < terms; ++k)
            A(i, k) = ogden_shape(test.stretch[static_cast<std::size_t>(i)], alpha[static_cast<std::size_t>(k)]);
    }
    const VectorXd mu = linalg::least_squares(A, map(test.stress_Pa) / scale);
    VectorXd x(2 * terms);
    for (Index k = 0; k < terms; ++k) {
        x[2 * k] = mu[k];
        x[2 * k + 1] = alpha[static_cast<std::size_t>(k)];
    }
    return x;
}

/// Common result of both fits: the constants, in Pa or 1, and the derivatives of the stress.
struct Solution {
    VectorXd x;
    MatrixXd J;
};

Result<Solution> fit_ogden(const TensileTest& test, int terms) {
    const double scale = map(test.stress_Pa).cwiseAbs().maxCoeff();
    const OgdenResiduals residuals{test, terms, scale};
    Solution best;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& alpha : ogden_starts(terms)) {
        VectorXd x = ogden_start(test, alpha, scale);
        OgdenResiduals functor = residuals;
        Eigen::LevenbergMarquardt<OgdenResiduals> search(functor);
        search.parameters.maxfev = 2000;
        search.parameters.xtol = search.parameters.ftol = 1e-13;
        search.minimize(x);
        VectorXd r(residuals.values());
        residuals(x, r);
        const bool sane = x.allFinite() && r.allFinite() && x.cwiseAbs().maxCoeff() < 1e6;
        if (!sane || !(r.squaredNorm() < least)) continue;
        least = r.squaredNorm();
        best.x = x;
    }
    if (best.x.size() == 0) return failure("no start of the search led to an Ogden law; try fewer terms");
    best.J.resize(residuals.values(), residuals.inputs());
    residuals.df(best.x, best.J);
    for (int k = 0; k < terms; ++k) {
        best.x[2 * k] *= scale;
        best.J.col(2 * k + 1) *= scale;
    }
    return best;
}

Solution fit_linear(const TensileTest& test, FitLaw law) {
    Solution solution;
    solution.J = linear_design(law, test.stretch);
    solution.x = linalg::least_squares(solution.J, map(test.stress_Pa));
    return solution;
}

material::Law make_law(const FitOptions& options, const VectorXd& x) {
    const auto bulk = [&](double shear) { return material::bulk_modulus(shear, options.poisson_ratio); };
    switch (options.law) {
        case FitLaw::neo_hookean:
            return material::NeoHookean{x[0] / 3, bulk(x[0] / 3)};
        case FitLaw::mooney_rivlin:
            return material::MooneyRivlin{x[0], x[1], bulk(2 * (x[0] + x[1]))};
        case FitLaw::yeoh:
            return material::Yeoh{x[0], x[1], x[2], bulk(2 * x[0])};
        case FitLaw::ogden:
            break;
    }
    material::Ogden law{};
    law.terms = static_cast<int>(x.size() / 2);
    double shear = 0;
    for (int k = 0; k < law.terms; ++k) {
        law.mu_Pa[k] = x[2 * k];
        law.alpha[k] = x[2 * k + 1];
        shear += law.mu_Pa[k];
    }
    law.bulk_Pa = bulk(shear);
    return law;
}

std::vector<std::string> constant_names(const FitOptions& options) {
    switch (options.law) {
        case FitLaw::neo_hookean:
            return {"youngs_modulus"};
        case FitLaw::mooney_rivlin:
            return {"c10", "c01"};
        case FitLaw::yeoh:
            return {"c10", "c20", "c30"};
        case FitLaw::ogden:
            break;
    }
    std::vector<std::string> names;
    for (int k = 0; k < options.terms; ++k) names.insert(names.end(), {"mu", "alpha"});
    return names;
}

/// At stretch 1 every law gives zero stress, whatever its constants, and most machines are set to zero there.
bool is_useful(double stretch) {
    return std::fabs(stretch - 1) > 1e-9;
}

/// Number of informative rows.
std::size_t useful_rows(const TensileTest& test) {
    return static_cast<std::size_t>(std::count_if(test.stretch.begin(), test.stretch.end(), is_useful));
}

/// Standard deviation of the stress about the fit, from the informative rows. Precondition: more of them than
/// constants.
double noise_Pa(const TensileTest& test, const std::vector<double>& fitted_Pa, std::size_t constants) {
    double squares = 0;
    for (std::size_t i = 0; i < test.stretch.size(); ++i) {
        if (is_useful(test.stretch[i])) squares += std::pow(fitted_Pa[i] - test.stress_Pa[i], 2);
    }
    return std::sqrt(squares / static_cast<double>(useful_rows(test) - constants));
}

/// The terms of Ogden's law, from 1, whose exponents nearly equal that of another term: only the sum of their mu
/// counts.
std::vector<int> alike_terms(const material::Law& law) {
    constexpr double alike = 0.05;
    std::vector<int> terms;
    const auto* ogden = std::get_if<material::Ogden>(&law);
    for (int a = 0; ogden != nullptr && a < ogden->terms; ++a) {
        for (int b = 0; b < ogden->terms; ++b) {
            if (a == b || std::fabs(ogden->alpha[a] - ogden->alpha[b]) > alike * std::fabs(ogden->alpha[a])) continue;
            terms.push_back(a + 1);
            break;
        }
    }
    return terms;
}

/// The constants of which the data determine no more than a combination. `unit`: derivatives of the stress with respect
/// to each, of length 1.
std::vector<bool> undetermined(const MatrixXd& unit, const material::Law& law) {
    constexpr double rank_tolerance = 1e-6, takes_part = 0.1;
    std::vector<bool> open(static_cast<std::size_t>(unit.cols()), false);
    const linalg::Svd svd = linalg::svd(unit, linalg::SvdParts::square_right);
    for (Index k = 0; k < unit.cols(); ++k) {
        if (k < svd.sigma.size() && svd.sigma[k] > rank_tolerance * svd.sigma[0]) continue;
        for (Index j = 0; j < unit.cols(); ++j)
            if (std::fabs(svd.V(j, k)) > takes_part) open[static_cast<std::size_t>(j)] = true;
    }
    for (const int term : alike_terms(law)) {
        const auto first = static_cast<std::size_t>(2 * (term - 1));
        open[first] = open[first + 1] = true;
    }
    return open;
}

void warn_of_undetermined(Fit& fit) {
    std::vector<std::string> names;
    for (const int term : alike_terms(fit.law)) names.push_back(std::to_string(term));
    if (!names.empty()) {
        fit.warnings.push_back(
            fmt::format("the data cannot tell terms {} apart: their exponents are nearly equal, and only the sum of "
                        "their mu counts; use fewer terms",
                        join_names(names)));
        return;
    }
    if (std::ranges::any_of(fit.constants, [](const Constant& c) { return !std::isfinite(c.half_width); }))
        fit.warnings.emplace_back(
            "the data cannot tell some constants apart: a change of one looks like a change of the others; use a law "
            "with fewer constants, or measure over a wider range of stretches");
}

void add_warnings(const TensileTest& test, Fit& fit) {
    warn_of_undetermined(fit);
    const auto [low, high] = std::minmax_element(test.stretch.begin(), test.stretch.end());
    if (!(material::moduli(fit.law).shear_Pa > 0))
        fit.warnings.emplace_back("the initial shear modulus is not above zero: no simulation can use this law");
    for (std::string& text : unstable_ranges(fit.law, *low, *high)) fit.warnings.push_back(std::move(text));
    for (const Constant& c : fit.constants) {
        if (std::isfinite(c.half_width) && c.half_width > std::fabs(c.value))
            fit.warnings.push_back(fmt::format("{} cannot be told from zero with these data", c.name));
    }
}

}  // namespace

double uniaxial_stress_Pa(const material::Law& law, double l) {
    // The deformation is isochoric, so the law's own pressure is zero or cancels.
    const material::Matrix3 F = Eigen::Vector3d(l, 1 / std::sqrt(l), 1 / std::sqrt(l)).asDiagonal();
    const material::Matrix3 P = material::stress(law, F);
    return P(0, 0) - P(1, 1) * std::pow(l, -1.5);
}

double student_t_95(int freedom) {
    if (freedom == 1) return 12.7062;
    if (freedom == 2) return 4.30265;
    // Cornish-Fisher expansion about the normal distribution's 97.5 % point (Abramowitz and Stegun, 26.7.5).
    const double z = 1.959964;
    const double n = freedom;
    const double z2 = z * z;
    return z * (1 + (z2 + 1) / (4 * n) + ((5 * z2 + 16) * z2 + 3) / (96 * n * n) +
                (((3 * z2 + 19) * z2 + 17) * z2 - 15) / (384 * n * n * n) +
                ((((79 * z2 + 776) * z2 + 1482) * z2 - 1920) * z2 - 945) / (92160 * n * n * n * n));
}

Result<Fit> fit(const TensileTest& test, const FitOptions& options) {
    const std::vector<std::string> names = constant_names(options);
    if (useful_rows(test) < names.size() + 1)
        return input_error("{} rows with a stretch other than 1 are too few for {} constants; {} at least",
                           useful_rows(test), names.size(), names.size() + 1);
    if (map(test.stress_Pa).cwiseAbs().maxCoeff() == 0) return input_error("the stress is zero in every row");
    Solution solution;
    if (options.law == FitLaw::ogden) {
        Result<Solution> found = fit_ogden(test, options.terms);
        if (!found) return tl::unexpected(found.error());
        solution = std::move(*found);
    } else {
        solution = fit_linear(test, options.law);
    }
    Fit result{make_law(options, solution.x), options.poisson_ratio, {}, 0, 0, {}, {}};
    for (const double l : test.stretch) result.stress_Pa.push_back(uniaxial_stress_Pa(result.law, l));
    const auto rows = static_cast<double>(test.stretch.size());
    const double squares = (map(result.stress_Pa) - map(test.stress_Pa)).squaredNorm();
    const double mean = map(test.stress_Pa).mean();
    const double spread = (map(test.stress_Pa).array() - mean).matrix().squaredNorm();
    result.rms_error_Pa = std::sqrt(squares / rows);
    result.r_squared = spread > 0 ? 1 - squares / spread : 0;
    const auto freedom = static_cast<int>(useful_rows(test) - names.size());
    const double s = noise_Pa(test, result.stress_Pa, names.size());
    // Columns of different scale (Pa, exponents) are normalised before the inverse is computed.
    const VectorXd length = solution.J.colwise().norm();
    const MatrixXd unit = solution.J * length.cwiseInverse().asDiagonal();
    const MatrixXd C = linalg::pseudo_inverse(unit.transpose() * unit);
    const std::vector<bool> open = undetermined(unit, result.law);
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto k = static_cast<Index>(i);
        const double half = open[i] ? std::numeric_limits<double>::infinity()
                                    : student_t_95(freedom) * s * std::sqrt(std::max(0.0, C(k, k))) / length[k];
        result.constants.push_back({names[i], solution.x[k], half, names[i] != "alpha"});
    }
    add_warnings(test, result);
    return result;
}

}  // namespace pliant::calibrate
