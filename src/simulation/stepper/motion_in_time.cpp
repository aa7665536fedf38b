#include "simulation/stepper/motion_in_time.hpp"

#include <Eigen/Geometry>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "base/linalg/sparse.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"

namespace pliant::sim {

History MotionInTime::at_rest(const Eigen::VectorXd& x) const {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(x.size());
    const auto& objects = model_.description().objects;
    for (std::size_t k = 0; k < objects.size(); ++k) {
        const AffineBody& body = model_.objects()[k];
        const Eigen::Vector3d centre = body.centre(linalg::view(x));
        const Eigen::Vector3d spin = linalg::vector(objects[k].angular_velocity_rad_s);
        for (const int node : body.nodes())
            v.segment<3>(3 * node) =
                linalg::vector(objects[k].velocity_m_s) + spin.cross(x.segment<3>(3 * node) - centre);
    }
    return {x, v, x, v, 0};
}

History MotionInTime::still(const Eigen::VectorXd& x) {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(x.size());
    return {x, none, x, none, 0, true};
}

std::shared_ptr<const Inertia> MotionInTime::inertia(const History& history, double dt, Scheme scheme) {
    std::shared_ptr<StiffnessMatrix> stiffness;
    if (damping_.stiffness_s > 0) {
        if (!body_layout_) body_layout_ = make_body_layout();
        stiffness = std::make_shared<StiffnessMatrix>();
        stiffness->pattern = {body_layout_, &body_layout_->pattern};
        stiffness->values.assign(body_layout_->pattern.entries(), 0.0);
        const Eigen::VectorXd x = Inertia::damping_place(history, dt, scheme).of(history);
        model_.elements().add_strain_stiffness(linalg::view(x), body_layout_->element_sums, stiffness->values);
    }
    return std::make_shared<const Inertia>(model_.elements(), model_.free_index(), history, dt, damping_,
                                           std::move(stiffness), scheme);
}

History MotionInTime::after(const Inertia& inertia, const Eigen::VectorXd& x) {
    return {x, inertia.velocity(x), inertia.start().x, inertia.start().v, inertia.dt()};
}

double MotionInTime::kinetic_energy_J(const History& history) const {
    Eigen::VectorXd momentum = Eigen::VectorXd::Zero(history.v.size());
    model_.elements().apply_mass({history.v.data(), static_cast<std::size_t>(history.v.size())},
                                 {momentum.data(), static_cast<std::size_t>(momentum.size())});
    return 0.5 * history.v.dot(momentum);
}

/// Layout of the elements alone, over all nodes, for stiffness damping.
std::shared_ptr<const TangentLayout> MotionInTime::make_body_layout() const {
    std::vector<int> index(model_.free_index().size());
    std::iota(index.begin(), index.end(), 0);
    TangentLayout layout{linalg::make_pattern(static_cast<int>(index.size()), 3, model_.elements().cliques(index)), {}};
    layout.element_sums = model_.elements().block_sums(index, layout.pattern);
    return std::make_shared<const TangentLayout>(std::move(layout));
}

}  // namespace pliant::sim
