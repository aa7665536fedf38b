#include "simulation/gradient/guide_points.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "base/linalg/vectors.hpp"
#include "simulation/linearisation/met_segments.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

/// Derivatives with respect to the weight w of a node in an attachment: w changes the guide point by x dw, the adjoint
/// weight of a force by the node's weight, and the rest point by X dw.
struct ByWeight {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();    ///< times x, m
    Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< times the weight of the node's force
    Eigen::Vector3d at_rest = Eigen::Vector3d::Zero();  ///< times X, m
};

/// Derivatives of the measure with respect to a cable or spring.
struct Pull {
    CablePath path;
    double tension = 0;      ///< along the path
    double weighted = 0;     ///< with respect to its weighted length, through its own equation
    double length = 0;       ///< with respect to its length itself
    double rest_length = 0;  ///< with respect to its rest length
    std::vector<double> shares{};
    std::vector<double> by_segments{};  ///< with respect to the rest length of each segment, through segments whose
                                        ///< ends have met
};

/// Sets the derivatives of rest lengths through segments whose ends have met.
void add_met_segments(const Linearisation& at, const Eigen::VectorXd& weights, Pull& pull) {
    const Eigen::VectorXd& x = at.state().x;
    const MetSegments met(pull.path, view(x), pull.shares);
    pull.by_segments.assign(pull.path.segment_count(), 0.0);
    if (!met.any()) return;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(x.size());
    met.add_gradient_rate(pull.tension, view(force));
    const double worth = weights.dot(force) + pull.weighted * met.length_rate() +
                         pull.length * MetSegments(pull.path, view(x)).length_rate();
    const Eigen::VectorXd rest = at.system().rest().x;
    pull.by_segments = met_length_rates(pull.path, view(rest));
    for (double& rate : pull.by_segments) rate *= worth;
}

Pull pull_of_cable(const Linearisation& at, const Adjoint& adjoint, const Slope& of, std::size_t c, double by_rest) {
    const Actuator& actuator = at.system().actuators()[c];
    const double tension = actuator.gaps() == nullptr ? at.state().multiplier[static_cast<Eigen::Index>(c)] : 0;
    Pull cable{actuator.cable(), tension, 0, 0, by_rest, at.controls().shares[c]};
    const auto place = std::ranges::find(at.solved(), c) - at.solved().begin();
    const Eigen::Index first = at.size() - static_cast<Eigen::Index>(at.solved().size());
    if (place < static_cast<std::ptrdiff_t>(at.solved().size()) && !at.is_slack(c))
        cable.weighted = -adjoint.weights[first + place];
    for (const Slope::ByMeasure& own : of.by_measures) cable.length += own.actuator == c ? own.now : 0;
    return cable;
}

/// The force of a spring depends on its length and, without a given free length, on its rest length.
Pull pull_of_spring(const Linearisation& at, const Slope& of, std::size_t s, const Eigen::VectorXd& weights) {
    const Spring& spring = at.system().model().description().springs[s];
    const SpringPath& path = at.system().springs()[s];
    const Eigen::VectorXd rest = at.system().rest().x;
    Pull pull{CablePath(spring.points, view(rest))};
    for (const Slope::ByMeasure& own : of.by_springs) {
        if (own.actuator != s) continue;
        pull.length += own.now;
        pull.rest_length += own.at_rest;
    }
    const double force = path.force(view(at.state().x));
    if (spring.only_pulls && !(force > 0)) return pull;
    pull.tension = force;
    Eigen::VectorXd by_force = Eigen::VectorXd::Zero(weights.size());
    path.add_length_gradient(view(at.state().x), spring.stiffness_N_m, view(by_force));
    const double by_length = weights.dot(by_force);
    pull.length += by_length;
    if (!spring.free_length_m) pull.rest_length -= by_length;
    return pull;
}

/// t = d / |d|, or its replacement for a met segment.
Eigen::Vector3d along(const CablePath& path, const Eigen::Vector3d& d) {
    return d / std::max(d.norm(), path.met_length_m());
}

/// A segment pulls with tension t; the adjoint weights of its ends differ by u, so that it contributes u . t.
ByWeight of_segment(const Pull& pull, std::size_t k, const Eigen::VectorXd& x, const Eigen::VectorXd& rest,
                    const Eigen::VectorXd& weights) {
    const Eigen::Vector3d d = linalg::vector(pull.path.segment_vector(k, view(x)));
    const Eigen::Vector3d u = linalg::vector(pull.path.segment_motion(k, view(weights)));
    const double share = pull.shares.empty() ? 1 : pull.shares[k], met = pull.path.met_length_m();
    const Eigen::Vector3d t = along(pull.path, d);
    Eigen::Vector3d across = u / std::max(d.norm(), met);
    if (d.norm() >= met) across -= t.dot(u) / d.norm() * t;
    return {pull.tension * share * across + (pull.weighted * share + pull.length) * t, pull.tension * share * t,
            (pull.rest_length + pull.by_segments[k]) *
                along(pull.path, linalg::vector(pull.path.segment_vector(k, view(rest))))};
}

/// A guide point is the end of one segment and the start of the next.
ByWeight of_guide_point(const Pull& pull, std::size_t point, const Eigen::VectorXd& x, const Eigen::VectorXd& rest,
                        const Eigen::VectorXd& weights) {
    ByWeight sum;
    const auto add = [&](std::size_t segment, double sign) {
        const ByWeight one = of_segment(pull, segment, x, rest, weights);
        sum.place += sign * one.place;
        sum.weights += sign * one.weights;
        sum.at_rest += sign * one.at_rest;
    };
    if (point > 0) add(point - 1, 1);
    if (point < pull.path.segment_count()) add(point, -1);
    return sum;
}

}  // namespace

Eigen::VectorXd guide_gradient(const Linearisation& at, const Adjoint& adjoint, const Slope& of,
                               const Eigen::VectorXd& by_rest_measure, std::span<const GuidePoint> guides) {
    const Eigen::VectorXd& x = at.state().x;
    const Eigen::VectorXd rest = at.system().rest().x;
    const Eigen::VectorXd weights = at.force_weights(adjoint).head(x.size());
    Eigen::VectorXd result = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(guides.size()));
    std::optional<Pull> pull;  // of the path of the previous guide point
    for (std::size_t g = 0; g < guides.size(); ++g) {
        const GuidePoint& guide = guides[g];
        if (!pull || guide.path != guides[g - 1].path || guide.of_spring != guides[g - 1].of_spring) {
            pull = guide.of_spring ? pull_of_spring(at, of, guide.path, weights)
                                   : pull_of_cable(at, adjoint, of, guide.path,
                                                   by_rest_measure[static_cast<Eigen::Index>(guide.path)]);
            add_met_segments(at, weights, *pull);
        }
        const ByWeight by = of_guide_point(*pull, guide.point, x, rest, weights);
        auto sum = result.segment<3>(3 * static_cast<Eigen::Index>(g));
        if (guide.slope.nodes.empty()) sum = by.place + by.at_rest;  // fixed in space
        for (std::size_t k = 0; k < guide.slope.nodes.size(); ++k) {
            const int node = 3 * guide.slope.nodes[k];
            const double by_weight = by.place.dot(x.segment<3>(node)) + by.weights.dot(weights.segment<3>(node)) +
                                     by.at_rest.dot(rest.segment<3>(node));
            sum += by_weight * linalg::vector(guide.slope.weights[k]);
        }
    }
    return result;
}

}  // namespace pliant::sim
