// How what a trial gives changes with the unknowns.
#include <cmath>
#include <utility>

#include "simulation/gradient/variation.hpp"
#include "simulation/identify/trial.hpp"
#include "simulation/linearisation/contact_forces.hpp"
#include "simulation/linearisation/parameters.hpp"
#include "simulation/material/law_parameters.hpp"

namespace pliant::identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = sim::Parameter::Kind;

/// Half the difference between two variants, in the coordinate of an unknown. The numbers of a robot are linear in most
/// of its keys, and rational in the others: differences of them are exact, or nearly, and nothing is solved for them.
constexpr double half_step = 1e-4;

/// The numbers of a variant that its states are a function of.
struct Numbers {
    VectorXd parameters;
    std::vector<VectorXd> drives;  ///< (pieces)
};

/// Moduli that stand beside the constants of a law, which they follow from, count as 0: no change is taken twice.
double parameter_value(const Variant& variant, const sim::Parameter& parameter) {
    if (parameter.kind == Kind::law) {
        const material::Law& law = variant.model.description().materials[parameter.index].law;
        const std::size_t constants = material::parameters(law).front().direction.size();
        return parameter.part < constants ? parameter.value : 0;
    }
    if (!variant.program.dynamics) return parameter.value;
    if (parameter.kind == Kind::mass_damping) return variant.program.dynamics->damping.mass_per_s;
    if (parameter.kind == Kind::stiffness_damping) return variant.program.dynamics->damping.stiffness_s;
    return parameter.value;
}

Result<Numbers> numbers_of(const Variant& variant, const std::vector<const sim::Controls*>& pieces) {
    const sim::Equilibrium system(variant.model);
    Numbers numbers;
    for (const sim::Controls* piece : pieces) {
        const sim::Controls controls = system.controls(piece->time);
        numbers.drives.emplace_back(static_cast<Index>(controls.drives.size()));
        for (std::size_t a = 0; a < controls.drives.size(); ++a)
            numbers.drives.back()[static_cast<Index>(a)] = controls.drives[a].value;
    }
    sim::Controls controls = system.controls(0);  // where nothing touches
    controls.inertia = pieces.back()->inertia;
    auto at = sim::Linearisation::create(system, system.rest(), controls);
    if (!at) return tl::unexpected(at.error());
    const std::vector<sim::Parameter> all = sim::parameters(*at);
    numbers.parameters.resize(static_cast<Index>(all.size()));
    for (std::size_t k = 0; k < all.size(); ++k)
        numbers.parameters[static_cast<Index>(k)] = parameter_value(variant, all[k]);
    return numbers;
}

/// The rates of inputs() from those of the drives. Pressure loads are among the parameters.
VectorXd input_rates(const std::vector<sim::Parameter>& inputs, const sim::Description& d, const VectorXd& drives) {
    VectorXd rates = VectorXd::Zero(static_cast<Index>(inputs.size()));
    const auto steered = static_cast<Index>(d.cables.size() + d.chambers.size());
    for (Index a = 0; a < steered; ++a)
        rates[a] = inputs[static_cast<std::size_t>(a)].kind == Kind::pressure ? -drives[a] : drives[a];
    return rates;
}

}  // namespace

/// What the state before a piece does with each unknown, where there is a history.
struct Trial::Forward {
    std::vector<sim::History> by;  ///< (unknowns)

    /// The change of the forces of the piece, with what it begins at.
    [[nodiscard]] VectorXd force(const sim::Linearisation& at, std::size_t unknown) const {
        const sim::History& h = by[unknown];
        VectorXd force = VectorXd::Zero(h.x.size() + at.controls().obstacles.size());
        if (at.controls().inertia) {
            VectorXd inertia = VectorXd::Zero(h.x.size());
            from(at, unknown).add_gradient(VectorXd::Zero(h.x.size()), inertia);
            force.head(h.x.size()) += inertia;
        }
        VectorXd motion = VectorXd::Zero(force.size());
        motion.head(h.x.size()) = h.x;
        return force - sim::friction_stiffness_times(at.system(), at.state(), at.controls(), motion);
    }

    void go_on(const sim::Linearisation& at, std::size_t unknown, const VectorXd& x) {
        sim::History& h = by[unknown];
        VectorXd v = h.v;
        if (at.controls().inertia) v = from(at, unknown).velocity(x);
        h.x_before = std::exchange(h.x, x);
        h.v_before = std::exchange(h.v, std::move(v));
    }

private:
    [[nodiscard]] sim::Inertia from(const sim::Linearisation& at, std::size_t unknown) const {
        sim::History history = by[unknown];
        history.dt_before = at.controls().inertia->start().dt_before;
        return at.controls().inertia->from(std::move(history));
    }
};

Result<Rates> Trial::rates(const Source& source, std::span<const Unknown> unknowns, std::span<const double> at) const {
    std::vector<const sim::Controls*> pieces;
    for (const Piece& piece : pieces_) pieces.push_back(&piece.controls);
    Rates rates;
    std::vector<double> values(at.begin(), at.end());
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
        std::vector<Numbers> both;
        std::vector<double> ends;
        for (const double step : {half_step, -half_step}) {
            values[k] = unknowns[k].value_at(unknowns[k].coordinate(at[k]) + step);
            const auto variant = source.with(unknowns, values);
            if (!variant) return tl::unexpected(variant.error());
            auto numbers = numbers_of(**variant, pieces);
            if (!numbers) return tl::unexpected(numbers.error());
            both.push_back(std::move(*numbers));
            ends.push_back(values[k]);
        }
        values[k] = at[k];
        const double factor = unknowns[k].rate(at[k]) / (ends[0] - ends[1]);
        const auto rate = [&](const VectorXd& plus, const VectorXd& minus) -> VectorXd {
            return factor * (plus - minus);
        };
        const auto column = static_cast<Index>(k);
        const auto count = static_cast<Index>(unknowns.size());
        if (k == 0) rates.parameters.resize(both[0].parameters.size(), count);
        rates.parameters.col(column) = rate(both[0].parameters, both[1].parameters);
        rates.drives.resize(pieces.size(), MatrixXd(both[0].drives.front().size(), count));
        for (std::size_t p = 0; p < pieces.size(); ++p)
            rates.drives[p].col(column) = rate(both[0].drives[p], both[1].drives[p]);
    }
    return rates;
}

Result<MatrixXd> Trial::piece_slopes(const Piece& piece, const Rates& rates, std::size_t k, Forward& forward) const {
    auto at = sim::Linearisation::create(stepper_->system(), piece.state, piece.controls);
    if (!at) return tl::unexpected(at.error());
    const std::vector<sim::Parameter> inputs = sim::inputs(*at);
    std::vector<sim::Slope> slopes;
    for (const Channel& channel : channels_) {
        for (const sim::Measure& measure : channel.measures) slopes.push_back(sim::slope(*at, measure));
    }
    const Index count = rates.parameters.cols();
    MatrixXd of_measures(static_cast<Index>(slopes.size()), count);
    const auto with = [&](Index j) {
        sim::Variation variation;
        variation.inputs = input_rates(inputs, variant_->model.description(), rates.drives[k].col(j));
        variation.parameters = rates.parameters.col(j);
        return variation;
    };
    if (!has_history() && count > of_measures.rows()) {
        for (Index m = 0; m < of_measures.rows(); ++m) {
            const auto by = sim::gradient(*at, slopes[static_cast<std::size_t>(m)], {});
            if (!by) return tl::unexpected(by.error());
            for (Index j = 0; j < count; ++j) {
                const sim::Variation variation = with(j);
                of_measures(m, j) = by->inputs.dot(variation.inputs) + by->parameters.dot(variation.parameters);
            }
        }
    }
    for (Index j = 0; j < count && (has_history() || count <= of_measures.rows()); ++j) {
        const sim::Variation variation = with(j);
        sim::Derivative by = sim::derivative(*at, variation);
        if (has_history()) {
            const VectorXd force = forward.force(*at, static_cast<std::size_t>(j));
            const VectorXd free = at->system().restrict_to_free(force.head(piece.state.x.size()));
            by.equations.head(free.size()) += free;
            by.forces.head(force.size()) += force;
        }
        const auto answer = at->response(by);
        if (!answer) return tl::unexpected(answer.error());
        of_measures.col(j) = sim::changes(*at, slopes, variation, by, *answer);
        if (has_history()) forward.go_on(*at, static_cast<std::size_t>(j), answer->positions);
    }
    MatrixXd result(static_cast<Index>(channels_.size()), count);
    Index first = 0;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        const auto size = static_cast<Index>(channels_[c].measures.size());
        std::vector<double> values;
        for (Index m = 0; m < size; ++m) values.push_back(slopes[static_cast<std::size_t>(first + m)].value);
        const std::vector<double> by = channels_[c].slopes(values);
        const Eigen::Map<const Eigen::RowVectorXd> row(by.data(), size);
        result.row(static_cast<Index>(c)) = row * of_measures.middleRows(first, size);
        first += size;
    }
    return result;
}

Result<std::vector<MatrixXd>> Trial::slopes(const Source& source, std::span<const Unknown> unknowns,
                                            std::span<const double> at, Progress& progress) const {
    const Result<Rates> by = rates(source, unknowns, at);
    if (!by) return tl::unexpected(by.error());
    const VectorXd nothing = VectorXd::Zero(pieces_.front().state.x.size());
    Forward forward{std::vector<sim::History>(unknowns.size(), {nothing, nothing, nothing, nothing, 0})};
    std::vector<MatrixXd> at_stops(stops_.size());
    // At rest nothing has happened yet.
    at_stops[0] = MatrixXd::Zero(static_cast<Index>(channels_.size()), static_cast<Index>(unknowns.size()));
    for (std::size_t k = 1; k < pieces_.size(); ++k) {
        if (progress.cancelled()) return cancelled();
        progress.advance("derivatives", static_cast<double>(k) / static_cast<double>(pieces_.size()));
        auto slopes = piece_slopes(pieces_[k], *by, k, forward);
        if (!slopes)
            return failure("time {:.4g} has no derivative: {}", pieces_[k].controls.time, slopes.error().message);
        if (pieces_[k].stop >= 0) at_stops[static_cast<std::size_t>(pieces_[k].stop)] = std::move(*slopes);
    }
    std::vector<MatrixXd> result;
    for (const Place& place : places_)
        result.push_back(place.before == place.after ? at_stops[place.after]
                                                     : MatrixXd((1 - place.share) * at_stops[place.before] +
                                                                place.share * at_stops[place.after]));
    return result;
}

}  // namespace pliant::identify
