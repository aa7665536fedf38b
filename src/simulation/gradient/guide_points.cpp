#include "simulation/gradient/guide_points.hpp"

#include <algorithm>

#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

/// By the weight w of a node in an attachment: w moves the guide point by w x, takes w of the weight that a force on
/// the node has, and moves the point at rest by w X.
struct ByWeight {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();    ///< times x, m
    Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< times the weight of the node's force
    Eigen::Vector3d at_rest = Eigen::Vector3d::Zero();  ///< times X, m
};

/// What a cable does to the measure.
struct Pull {
    const CablePath& path;
    double tension = 0;      ///< that acts along the path
    double weighted = 0;     ///< by its weighted length: what its own equation asks for
    double length = 0;       ///< by its length as such
    double rest_length = 0;  ///< by its length at rest
    const std::vector<double>& shares;
};

Pull pull_of(const Linearisation& at, const Adjoint& adjoint, const Slope& of, std::size_t c, double by_rest) {
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

/// t = d / |d|, or what a met segment has instead.
Eigen::Vector3d along(const CablePath& path, const Eigen::Vector3d& d) {
    return d / std::max(d.norm(), path.met_length_m());
}

/// A segment pulls with tension t; the weights of its ends differ by u, so that it counts u . t.
ByWeight of_segment(const Pull& cable, std::size_t k, const Eigen::VectorXd& x, const Eigen::VectorXd& rest,
                    const Eigen::VectorXd& weights) {
    const Eigen::Vector3d d = linalg::vector(cable.path.segment_vector(k, view(x)));
    const Eigen::Vector3d u = linalg::vector(cable.path.segment_motion(k, view(weights)));
    const double share = cable.shares.empty() ? 1 : cable.shares[k], met = cable.path.met_length_m();
    const Eigen::Vector3d t = along(cable.path, d);
    Eigen::Vector3d across = u / std::max(d.norm(), met);
    if (d.norm() >= met) across -= t.dot(u) / d.norm() * t;
    return {cable.tension * share * across + (cable.weighted * share + cable.length) * t, cable.tension * share * t,
            cable.rest_length * along(cable.path, linalg::vector(cable.path.segment_vector(k, view(rest))))};
}

/// A guide point is the end of one segment and the beginning of the next.
ByWeight of_point(const Pull& cable, std::size_t point, const Eigen::VectorXd& x, const Eigen::VectorXd& rest,
                  const Eigen::VectorXd& weights) {
    ByWeight sum;
    const auto add = [&](std::size_t segment, double sign) {
        const ByWeight one = of_segment(cable, segment, x, rest, weights);
        sum.place += sign * one.place;
        sum.weights += sign * one.weights;
        sum.at_rest += sign * one.at_rest;
    };
    if (point > 0) add(point - 1, 1);
    if (point < cable.path.segment_count()) add(point, -1);
    return sum;
}

}  // namespace

Eigen::VectorXd guide_gradient(const Linearisation& at, const Adjoint& adjoint, const Slope& of,
                               const Eigen::VectorXd& by_rest_measure, std::span<const GuidePoint> guides) {
    const Eigen::VectorXd& x = at.state().x;
    const Eigen::VectorXd rest = at.system().rest().x;
    const Eigen::VectorXd weights = at.force_weights(adjoint).head(x.size());
    Eigen::VectorXd result = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(guides.size()));
    for (std::size_t g = 0; g < guides.size(); ++g) {
        const GuidePoint& guide = guides[g];
        const Pull cable =
            pull_of(at, adjoint, of, guide.cable, by_rest_measure[static_cast<Eigen::Index>(guide.cable)]);
        const ByWeight by = of_point(cable, guide.point, x, rest, weights);
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
