#include "simulation/identify/confidence.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/linalg/dense.hpp"
#include "simulation/calibrate/fit.hpp"

namespace pliant::sim::identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double rank_tolerance = 1e-6;
constexpr double high_correlation = 0.99;
/// Entries of a unit singular vector below this are ignored.
constexpr double takes_part = 0.1;

/// Rows that depend on some unknown: others, such as a prescribed length, carry no information about the error of the
/// fit.
struct Telling {
    Index rows = 0;
    double squares = 0;  ///< of their residuals
};
Telling telling_rows(const MatrixXd& J, const VectorXd& r, double negligible) {
    Telling telling;
    for (Index i = 0; i < J.rows(); ++i) {
        if (!(J.row(i).norm() > negligible)) continue;
        ++telling.rows;
        telling.squares += r[i] * r[i];
    }
    return telling;
}

void add_group(std::vector<std::size_t> group, std::vector<std::vector<std::size_t>>& groups) {
    if (group.size() > 1 && std::ranges::find(groups, group) == groups.end()) groups.push_back(std::move(group));
}

}  // namespace

Confidence confidence(const MatrixXd& J, const VectorXd& r, const std::vector<bool>& held, double negligible) {
    const Index count = J.cols();
    Confidence result{VectorXd::Constant(count, none), MatrixXd::Constant(count, count, none), {}, {}};
    std::vector<std::size_t> known;
    for (Index j = 0; j < count; ++j) {
        result.matters.push_back(J.col(j).norm() > negligible);
        if (result.matters.back() && !held[static_cast<std::size_t>(j)]) known.push_back(static_cast<std::size_t>(j));
    }
    if (known.empty()) return result;
    const auto size = static_cast<Index>(known.size());
    MatrixXd unit(J.rows(), size);
    VectorXd length(size);
    for (Index k = 0; k < size; ++k) {
        const auto column = J.col(static_cast<Index>(known[static_cast<std::size_t>(k)]));
        length[k] = column.norm();
        unit.col(k) = column / length[k];
    }
    const linalg::Svd svd = linalg::svd(unit, linalg::SvdParts::square_right);
    VectorXd inverse(size);
    bool singular = false;
    for (Index k = 0; k < size; ++k) {
        const double value = k < svd.sigma.size() ? svd.sigma[k] : 0;
        inverse[k] = 1 / std::max(value, std::numeric_limits<double>::min());
        if (value > rank_tolerance * svd.sigma[0]) continue;
        singular = true;
        std::vector<std::size_t> group;
        for (Index j = 0; j < size; ++j) {
            if (std::fabs(svd.V(j, k)) > takes_part) group.push_back(known[static_cast<std::size_t>(j)]);
        }
        add_group(group, result.mixed);
    }
    if (singular) return result;
    const MatrixXd root = svd.V * inverse.asDiagonal();
    const MatrixXd C = root * root.transpose();
    const Telling telling = telling_rows(unit * length.asDiagonal(), r, negligible);
    const auto freedom = static_cast<int>(telling.rows - size);
    const double s = freedom > 0 ? std::sqrt(telling.squares / freedom) : none;
    for (Index j = 0; j < size; ++j) {
        const auto a = static_cast<Index>(known[static_cast<std::size_t>(j)]);
        if (freedom > 0) result.half_width[a] = calibrate::student_t_95(freedom) * s * std::sqrt(C(j, j)) / length[j];
        for (Index k = 0; k < size; ++k) {
            const auto b = static_cast<Index>(known[static_cast<std::size_t>(k)]);
            result.correlation(a, b) = C(j, k) / std::sqrt(C(j, j) * C(k, k));
            if (k > j && std::fabs(result.correlation(a, b)) > high_correlation)
                add_group({static_cast<std::size_t>(a), static_cast<std::size_t>(b)}, result.mixed);
        }
    }
    return result;
}

}  // namespace pliant::sim::identify
