#include "simulation/identify/at_bounds.hpp"

#include <algorithm>
#include <cmath>

#include "base/linalg/dense.hpp"
#include "simulation/identify/confidence.hpp"

namespace pliant::sim::identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// J without the columns of unknowns that do not matter, and of those at bounds or of the others.
MatrixXd columns(const MatrixXd& J, const std::vector<End>& ends, const std::vector<bool>& matters, bool at_bound) {
    MatrixXd some = J;
    for (std::size_t j = 0; j < ends.size(); ++j)
        if (!matters[j] || (ends[j].inward != 0) != at_bound) some.col(static_cast<Index>(j)).setZero();
    return some;
}

bool has_bound(const std::vector<std::size_t>& group, const std::vector<End>& ends) {
    return std::ranges::any_of(group, [&](std::size_t j) { return ends[j].inward != 0; });
}

}  // namespace

AtBounds at_bounds(const MatrixXd& J, const VectorXd& r, const std::vector<End>& ends, double negligible,
                   const std::vector<int>& groups) {
    const VectorXd zero = VectorXd::Zero(J.cols());
    AtBounds result{zero, zero, zero, {}};
    if (std::ranges::all_of(ends, [](const End& end) { return end.inward == 0; })) return result;
    const std::vector<bool> none(ends.size(), false);
    const std::vector<bool> matters = which_matter(J, negligible);
    const MatrixXd inside = columns(J, ends, matters, false), held = columns(J, ends, matters, true);
    const VectorXd step = linalg::pseudo_inverse(inside + held) * -r;
    const Confidence known = confidence(J, r + J * step, none, negligible, groups);
    for (const auto& group : known.mixed)
        if (has_bound(group, ends)) result.mixed.push_back(group);

    const MatrixXd follow = -(linalg::pseudo_inverse(inside) * held);
    for (Index j = 0; j < J.cols(); ++j) {
        const auto& [inward, room] = ends[static_cast<std::size_t>(j)];
        if (inward == 0 || !matters[static_cast<std::size_t>(j)]) continue;
        const double allowed = inward * step[j] + known.half_width[j];
        result.reach[j] = std::clamp(allowed, 0.0, room);
        const double reach = std::isfinite(allowed) ? result.reach[j] : room;
        if (!(reach > 0)) continue;
        for (Index k = 0; k < J.cols(); ++k) {
            const double moved = follow(k, j) * inward;
            if (moved != 0) (moved < 0 ? result.below : result.above)[k] += std::fabs(moved) * reach;
        }
    }
    return result;
}

}  // namespace pliant::sim::identify
