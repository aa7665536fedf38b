// The tangent of an equilibrium: its pattern and its blocks.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/core/parallel.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/actuators/cross_matrix.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

using linalg::view;

TangentLayout Equilibrium::lay_out_tangent(const std::vector<std::vector<int>>& touching, TangentNodes nodes) const {
    const std::vector<int>& index = index_of(nodes);
    auto cliques = model_->elements().cliques(index);
    append_cliques_beside_tets(index, touching, cliques);
    const bool all = nodes == TangentNodes::all;
    TangentLayout layout{
        linalg::make_pattern(all ? model_->node_count() : model_->free_count(), 3, cliques), {}, nodes};
    const Eigen::VectorXd rest = all ? rest_ : free_positions(rest_);
    for (Eigen::Index k = 0; k < rest.size(); k += 3)
        layout.pattern.points.push_back({rest[k], rest[k + 1], rest[k + 2]});
    layout.element_sums = model_->elements().block_sums(index, layout.pattern);
    return layout;
}

void Equilibrium::append_cliques_beside_tets(const std::vector<int>& index,
                                             const std::vector<std::vector<int>>& touching,
                                             linalg::Lists& cliques) const {
    for (const Actuator& actuator : actuators_) actuator.append_cliques(index, cliques);
    for (const Plate& plate : plates_) plate.append_clique(index, cliques);
    for (const AffineBody& object : objects()) object.append_clique(index, cliques);
    for (const SpringPath& spring : springs_) spring.append_clique(index, cliques);
    for (const JointForce& joint : joints_) joint.append_clique(index, cliques);
    for (const TorqueForces& torque : torques_) torque.append_clique(index, cliques);
    if (fluid_) {
        for (const auto& triangle : fluid_->closed_skin()) {
            std::vector<int> clique;
            for (const int& corner : triangle) {
                for (const int node : model_->object_points().carriers(corner))
                    clique.push_back(index[static_cast<std::size_t>(node)]);
            }
            std::ranges::sort(clique);
            clique.erase(std::unique(clique.begin(), clique.end()), clique.end());
            cliques.push_back(clique);
        }
    }
    for (const std::vector<int>& clique : touching) cliques.push_back(clique);
}

TangentLayout Equilibrium::lay_out_tangent_beside_tets(const std::vector<std::vector<int>>& touching) const {
    linalg::Lists cliques;
    append_cliques_beside_tets(all_nodes_, touching, cliques);
    return {linalg::make_pattern(model_->node_count(), 3, cliques), {}, TangentNodes::all};
}

void Equilibrium::add_tangent_at(const State& state, const Controls& controls, const TangentLayout& layout,
                                 std::span<double> values, bool project, TangentParts parts) const {
    model_->elements().add_tangent(view(state.x), layout.element_sums, values, project);
    add_tangent_beside_tets(state, controls, layout, values, project, parts);
}

/// The derivative of the force at share s of the path with respect to the end is s times the tangent there.
void Equilibrium::add_tangent(const State& state, const Controls& controls, const TangentLayout& layout,
                              std::span<double> values, bool project, TangentParts parts) const {
    const Inertia* inertia = controls.inertia.get();
    if (controls.of_means()) {
        for (const Inertia::Mean& at : inertia->means()) {
            std::vector<double> there(values.size(), 0.0);
            add_tangent_at({inertia->on_path(state.x, at.share), state.multiplier}, controls, layout, there, project,
                           parts);
            for (std::size_t k = 0; k < values.size(); ++k) values[k] += at.weight * at.share * there[k];
        }
    } else {
        add_tangent_at(state, controls, layout, values, project, parts);
    }
    if (controls.of_means()) {
        for (std::size_t k = 0; k < objects().size(); ++k)
            objects()[k].add_mean_hessian(view(inertia->start().x), view(state.x), controls.object_stress[k],
                                          index_of(layout.nodes), layout.pattern, values, project);
    }
    if (inertia != nullptr) {
        inertia->add_hessian(layout.element_sums, index_of(layout.nodes), layout.pattern, values);
        if (fluid_) add_drag_tangent(state.x, controls, *inertia, layout, values);
    }
    if (layout.nodes == TangentNodes::free) decouple_rollers(layout.pattern, values);
}

void Equilibrium::add_tangent_beside_tets(const State& state, const Controls& controls, const TangentLayout& layout,
                                          std::span<double> values, bool project, TangentParts parts) const {
    const linalg::SymmetricPattern& pattern = layout.pattern;
    const std::vector<int>& index = index_of(layout.nodes);
    // In a motion in time the masses hold against the negative curvature, and the exact stiffness converges faster.
    const bool project_plates = project && controls.inertia == nullptr;
    for (const Plate& plate : plates_) plate.add_hessian(view(state.x), index, pattern, values, project_plates);
    if (!controls.of_means()) {
        for (const AffineBody& object : objects()) object.add_hessian(view(state.x), index, pattern, values, project);
    }
    for (const SpringPath& spring : springs_) spring.add_hessian(view(state.x), index, pattern, values, project);
    for (std::size_t j = 0; j < joints_.size(); ++j)
        joints_[j].add_hessian(view(state.x), joint_drive(controls, j), index, pattern, values, project);
    for (std::size_t k = 0; k < torques_.size(); ++k)
        torques_[k].add_tangent(view(state.x), controls.torque_Nm[k], TorqueForces::Part::symmetric, index, pattern,
                                values);
    if (fluid_) {
        const std::vector<double> all = with_obstacles(state.x, {});
        visit_carried(layout, values, [&](const contact::BlockVisitor& visit) {
            fluid_->visit_buoyancy(all, gravity_at(controls.time), project, visit);
        });
    }
    const contact::Contact* contact = parts == TangentParts::all ? this->contact(controls) : nullptr;
    if (contact != nullptr) {
        const std::vector<double> x = with_obstacles(state.x, controls.obstacles);
        const contact::BlockVisitor add = [&](int a, int b, const linalg::Matrix3& block) {
            const int i = index[static_cast<std::size_t>(a)];
            const int j = index[static_cast<std::size_t>(b)];
            if (j >= 0 && i >= j) pattern.add_block(values, i, j, [&](int r, int c) { return block(r, c); });
        };
        const contact::BlockVisitor add_carried = [&](int a, int b, const linalg::Matrix3& block) {
            model_->object_points().visit_block(a, b, block, add);
        };
        contact->visit_hessian(contact->find(x), x, project, add_carried);
        if (controls.friction) controls.friction->visit_hessian(x, add_carried);
    }
    for (std::size_t a = 0; a < actuators_.size(); ++a) {
        const double multiplier = state.multiplier[static_cast<Eigen::Index>(a)];
        if (multiplier != 0 || actuators_[a].gaps() != nullptr)
            actuators_[a].add_hessian(view(state.x), multiplier, index, pattern, values, project, controls.shares[a]);
    }
}

void Equilibrium::add_skew(const State& state, const Controls& controls, const TangentLayout& layout,
                           std::span<double> values) const {
    const std::vector<int>& index = index_of(layout.nodes);
    for (std::size_t k = 0; k < torques_.size(); ++k)
        torques_[k].add_tangent(view(state.x), controls.torque_Nm[k], TorqueForces::Part::skew, index, layout.pattern,
                                values);
    model_->elements().add_skew(view(state.x), index, layout.pattern, values);
    std::vector<std::size_t> patches = skew_;
    if (layout.nodes == TangentNodes::all) {  // where a rim is held, it affects the forces on other nodes
        patches.clear();
        const std::size_t first = cable_count() + model_->description().chambers.size();
        for (std::size_t a = 0; a < actuators_.size(); ++a)
            if (a >= first || actuators_[a].has_mouths()) patches.push_back(a);
    }
    for (const std::size_t a : patches)
        actuators_[a].add_skew(view(state.x), state.multiplier[static_cast<Eigen::Index>(a)], index, layout.pattern,
                               values);
}

void Equilibrium::decouple_rollers(const linalg::SymmetricPattern& pattern, std::span<double> values) const {
    if (rollers_.empty()) return;
    std::vector<const Eigen::Matrix3d*> may_move(static_cast<std::size_t>(pattern.nodes), nullptr);
    for (const FreeRoller& roller : rollers_) may_move[static_cast<std::size_t>(roller.free)] = &roller.may_move;
    const auto decouple = [&](std::size_t i, std::size_t j, double* entries) {
        if (may_move[i] == nullptr && may_move[j] == nullptr) return;
        Eigen::Map<Eigen::Matrix3d> block(entries);
        const double stiffness = std::fabs(block.trace()) / 3;
        if (may_move[i] != nullptr) block = (*may_move[i] * block).eval();
        if (may_move[j] != nullptr) block = (block * *may_move[j]).eval();
        if (i == j) block += stiffness * (Eigen::Matrix3d::Identity() - *may_move[j]);
    };
    parallel_for(may_move.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j) {
            for (int k = pattern.node_start[j]; k < pattern.node_start[j + 1]; ++k)
                decouple(static_cast<std::size_t>(pattern.node_row[static_cast<std::size_t>(k)]), j,
                         values.data() + 9 * static_cast<std::size_t>(k));
        }
    });
}

Eigen::VectorXd Equilibrium::apply_skew(const State& state, const Eigen::VectorXd& v) const {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(state.x.size());
    add_free(v, 1, motion);
    Eigen::VectorXd result = Eigen::VectorXd::Zero(state.x.size());
    for (const std::size_t a : skew_) {
        const double multiplier = state.multiplier[static_cast<Eigen::Index>(a)];
        actuators_[a].apply_skew(view(state.x), multiplier, view(std::as_const(motion)), view(result));
    }
    return restrict_to_free(result);
}

/// A torque T on nodes at r_i from their mean, with M = sum r_i r_i^T, changes with their rotation t by -M [w]x t, as
/// the forces w x r_i turn: their moment is kept. Its skew part is -(M [w]x + [w]x M)/2 = -[T]x/2.
Equilibrium::TorqueSkew Equilibrium::torque_skew(const State& state, const Controls& controls) const {
    std::vector<std::size_t> acting;
    for (std::size_t k = 0; k < torques_.size(); ++k)
        if (!controls.torque_Nm[k].isZero(0)) acting.push_back(k);
    TorqueSkew part;
    if (acting.empty()) return part;
    double share = 1;
    if (controls.of_means()) {  // the forces within the step change less than those at its end, where the turns are
        share = 0;
        for (const Inertia::Mean& at : controls.inertia->means()) share += at.weight * at.share;
    }
    const auto count = static_cast<Eigen::Index>(3 * acting.size());
    part.turns.resize(3 * model_->free_count(), count);
    part.skew = Eigen::MatrixXd::Zero(count, count);
    Eigen::Index column = 0;
    for (const std::size_t k : acting) {
        part.skew.block<3, 3>(column, column) = -0.5 * share * cross_matrix(controls.torque_Nm[k]);
        for (int axis = 0; axis < 3; ++axis) {
            Eigen::VectorXd forces = Eigen::VectorXd::Zero(state.x.size());
            torques_[k].subtract_from(view(state.x), -Eigen::Vector3d::Unit(axis), view(forces));
            part.turns.col(column++) = restrict_to_free(forces);
        }
    }
    return part;
}

}  // namespace pliant::sim
