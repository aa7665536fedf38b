#include "simulation/reduced/reduced_model.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/reduced/sampled_robot.hpp"

namespace pliant::sim::reduced {
namespace {

/// `rest`: the state of the whole robot.
Status check_fits(const Model& model, const State& rest, const Reduction& reduction) {
    const Eigen::Index size = rest.x.size(), actuators = rest.multiplier.size();
    const std::size_t steered = model.description().steered_count();
    const auto fits = [&](const Sample& sample) {
        return sample.state.x.size() == size && sample.state.multiplier.size() == actuators &&
               sample.inputs.drives.size() == steered && sample.amplitudes.size() == reduction.used;
    };
    const auto is_tet = [&](const Weight& tet) { return tet.column < model.mesh().tet_count(); };
    if (reduction.modes.rows() != size || reduction.used < 1 || reduction.used > reduction.modes.cols() ||
        reduction.samples.empty() || !std::ranges::all_of(reduction.samples, fits) ||
        !std::ranges::all_of(reduction.tets, is_tet) || !std::ranges::all_of(reduction.check_tets, is_tet))
        return input_error("it belongs to another robot");
    return {};
}

}  // namespace

Result<ReducedModel> ReducedModel::create(const Model& model, Reduction reduction) {
    if (Status status = check_reducible(model.description()); !status) return tl::unexpected(status.error());
    State rest = Equilibrium(model).rest();
    if (Status status = check_fits(model, rest, reduction); !status) return tl::unexpected(status.error());
    ReducedModel made;
    made.model_ = &model;
    made.rest_ = std::move(rest.x);
    const Description& d = model.description();
    Result<ProjectedModel> part = ProjectedModel::create(d, reduction.modes.leftCols(reduction.used), reduction.tets);
    if (!part) return tl::unexpected(part.error());
    Result<ProjectedModel> check_part = ProjectedModel::create(d, reduction.modes, reduction.check_tets);
    if (!check_part) return tl::unexpected(check_part.error());
    made.part_ = std::move(*part);
    made.check_part_ = std::move(*check_part);
    made.units_ = std::make_unique<InputUnits>(made.part_->system(), 1);
    made.take_measures(reduction.samples);
    for (const Sample& sample : reduction.samples) made.reach_m_ = std::max(made.reach_m_, sample.amplitudes.norm());
    made.reduction_ = std::move(reduction);
    return made;
}

void ReducedModel::take_measures(const std::vector<Sample>& samples) {
    for (const Sample& sample : samples) {
        const Eigen::VectorXd x = part_->positions(sample.amplitudes);
        std::vector<double>& measures = measures_.emplace_back();
        for (const Actuator& actuator : part_->system().actuators())
            measures.push_back(actuator.measure(linalg::view(x)));
    }
}

Inputs ReducedModel::inputs_of_sample(std::size_t sample, const Inputs& like) const {
    const Sample& known = reduction_.samples[sample];
    const double ambient = model_->description().ambient_pressure_Pa;
    Inputs inputs = known.inputs;
    for (std::size_t a = 0; a < inputs.drives.size(); ++a) {
        Drive& drive = inputs.drives[a];
        if (drive.kind == like.drives[a].kind) continue;
        const double g = measures_[sample][a], m = known.state.multiplier[static_cast<Eigen::Index>(a)];
        drive.kind = like.drives[a].kind;
        if (drive.kind == Drive::Kind::measure) drive.value = g;
        if (drive.kind == Drive::Kind::multiplier) drive.value = m;
        if (drive.kind == Drive::Kind::gas) drive.value = (ambient - m) * g;
    }
    return inputs;
}

std::size_t ReducedModel::nearest_sample(const Inputs& inputs) const {
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < reduction_.samples.size(); ++k) {
        const double apart = distance(inputs_of_sample(k, inputs), inputs);
        if (!(apart < least)) continue;
        least = apart;
        nearest = k;
    }
    return nearest;
}

double ReducedModel::distance(const Inputs& from, const Inputs& to) const {
    return units_->change(from, to).norm();
}

}  // namespace pliant::sim::reduced
