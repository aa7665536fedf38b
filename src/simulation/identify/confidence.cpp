#include "simulation/identify/confidence.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

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
/// A group with a smaller share of the squared weights of an estimate is ignored if its noise is not known.
constexpr double small_share = 1e-3;
constexpr double rounding = 1e-6;

int group_of(const std::vector<int>& groups, Index row) {
    return groups.empty() ? 0 : groups[static_cast<std::size_t>(row)];
}

/// The noise of one group of rows.
struct Noise {
    double freedom = 0;  ///< values to spare
    double squares = 0;  ///< of the residuals
    [[nodiscard]] bool known() const { return freedom > 1 - rounding; }
    [[nodiscard]] double variance() const { return squares / freedom; }
};

/// `leverage`: diagonal of J (J^T J)^-1 J^T. Rows that depend on no unknown, such as a prescribed length, carry no
/// information about the noise.
std::map<int, Noise> noise_of(const MatrixXd& J, const VectorXd& r, const VectorXd& leverage,
                              const std::vector<int>& groups, double negligible) {
    std::map<int, Noise> all;
    for (Index i = 0; i < J.rows(); ++i) {
        if (!(J.row(i).norm() > negligible)) continue;
        Noise& noise = all[group_of(groups, i)];
        noise.freedom += 1 - leverage[i];
        noise.squares += r[i] * r[i];
    }
    return all;
}

/// Half the width of an interval, from the weights with which the residuals enter the estimate; NaN if it rests on a
/// group whose noise is not known, which is added to `unclear`. Freedom: Satterthwaite 1946.
double half_width(const VectorXd& weights, const std::vector<int>& groups, const std::map<int, Noise>& noises,
                  std::set<int>& unclear) {
    std::map<int, double> of_group;
    for (Index i = 0; i < weights.size(); ++i) of_group[group_of(groups, i)] += weights[i] * weights[i];
    double variance = 0, spread = 0;
    bool clear = true;
    for (const auto& [group, noise] : noises) {
        const double share = of_group[group];
        if (!noise.known()) {
            if (share < small_share * weights.squaredNorm()) continue;
            unclear.insert(group);
            clear = false;
            continue;
        }
        const double part = share * noise.variance();
        variance += part;
        spread += part * part / noise.freedom;
    }
    if (!clear) return none;
    if (!(variance > 0)) return 0;
    const double freedom = std::clamp(variance * variance / spread + rounding, 1.0, 1e6);
    return calibrate::student_t_95(static_cast<int>(freedom)) * std::sqrt(variance);
}

void add_group(std::vector<std::size_t> group, std::vector<std::vector<std::size_t>>& groups) {
    if (group.size() > 1 && std::ranges::find(groups, group) == groups.end()) groups.push_back(std::move(group));
}

}  // namespace

std::vector<bool> which_matter(const MatrixXd& J, double negligible) {
    std::vector<bool> matters;
    for (Index j = 0; j < J.cols(); ++j) matters.push_back(J.col(j).norm() > negligible);
    return matters;
}

Confidence confidence(const MatrixXd& J, const VectorXd& r, const std::vector<bool>& held, double negligible,
                      const std::vector<int>& groups) {
    const Index count = J.cols();
    Confidence result{
        VectorXd::Constant(count, none), MatrixXd::Constant(count, count, none), which_matter(J, negligible), {}, {}};
    std::vector<std::size_t> known;
    for (Index j = 0; j < count; ++j) {
        const auto k = static_cast<std::size_t>(j);
        if (result.matters[k] && !held[k]) known.push_back(k);
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
    const MatrixXd weights = C * unit.transpose();
    const VectorXd leverage = unit.cwiseProduct(weights.transpose()).rowwise().sum();
    const auto noises = noise_of(unit * length.asDiagonal(), r, leverage, groups, negligible);
    for (Index j = 0; j < size; ++j) {
        const auto a = static_cast<Index>(known[static_cast<std::size_t>(j)]);
        result.half_width[a] = half_width(weights.row(j), groups, noises, result.unclear) / length[j];
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
