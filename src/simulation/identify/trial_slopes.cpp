// Derivatives of a trial with respect to the unknowns.
#include <cmath>
#include <memory>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/gradient/friction_slips.hpp"
#include "simulation/gradient/variation.hpp"
#include "simulation/identify/trial.hpp"
#include "simulation/linearisation/contact_forces.hpp"
#include "simulation/linearisation/damping_stiffness.hpp"
#include "simulation/linearisation/parameters.hpp"
#include "simulation/material/law_parameters.hpp"

namespace pliant::sim::identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ParameterKind = sim::Parameter::Kind;

/// Half the step between two variants, in the coordinate of an unknown. The numbers of a robot are linear in most of
/// its keys, and rational in the others: their differences are exact, or nearly, and need no solve.
constexpr double half_step = 1e-4;

/// The numbers of a variant that its states depend on.
struct Numbers {
    VectorXd parameters;
    std::vector<VectorXd> drives;  ///< (pieces)
};

/// Moduli listed in addition to the constants of a law count as 0, so that no change is counted twice.
double parameter_value(const Variant& variant, const sim::Parameter& parameter) {
    if (parameter.kind == ParameterKind::law) {
        const material::Law& law = variant.model.description().materials[parameter.index].law;
        const std::size_t constants = material::parameters(law).front().direction.size();
        return parameter.part < constants ? parameter.value : 0;
    }
    if (!variant.program.dynamics) return parameter.value;
    if (parameter.kind == ParameterKind::mass_damping) return variant.program.dynamics->damping.mass_per_s;
    if (parameter.kind == ParameterKind::stiffness_damping) return variant.program.dynamics->damping.stiffness_s;
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

/// The variation of each unknown at a piece. Pressure loads are among the parameters, and not counted twice.
std::vector<sim::Variation> variations(const sim::Linearisation& at, const Rates& rates, std::size_t piece) {
    const sim::Description& d = at.system().model().description();
    const std::vector<sim::Parameter> inputs = sim::inputs(at);
    std::vector<sim::Variation> all(static_cast<std::size_t>(rates.parameters.cols()));
    for (std::size_t j = 0; j < all.size(); ++j) {
        const auto column = static_cast<Index>(j);
        all[j].parameters = rates.parameters.col(column);
        all[j].inputs = VectorXd::Zero(static_cast<Index>(inputs.size()));
        for (std::size_t a = 0; a < d.steered_count(); ++a) {
            const double rate = rates.drives[piece](static_cast<Index>(a), column);
            all[j].inputs[static_cast<Index>(a)] = inputs[a].kind == ParameterKind::pressure ? -rate : rate;
        }
    }
    return all;
}

std::vector<sim::Slope> measure_slopes(const sim::Linearisation& at, std::span<const Channel> channels) {
    std::vector<sim::Slope> slopes;
    for (const Channel& channel : channels) {
        for (const sim::Measure& measure : channel.measures) slopes.push_back(sim::slope(at, measure));
    }
    return slopes;
}

/// (measures, unknowns) by one direct solve per unknown.
Result<MatrixXd> direct(sim::Linearisation& at, std::span<const sim::Slope> slopes,
                        std::span<const sim::Variation> unknowns) {
    MatrixXd result(static_cast<Index>(slopes.size()), static_cast<Index>(unknowns.size()));
    for (std::size_t j = 0; j < unknowns.size(); ++j) {
        const auto changes = sim::changes(at, slopes, unknowns[j]);
        if (!changes) return tl::unexpected(changes.error());
        result.col(static_cast<Index>(j)) = *changes;
    }
    return result;
}

/// The same by one transposed solve per measure.
Result<MatrixXd> transposed(sim::Linearisation& at, std::span<const sim::Slope> slopes,
                            std::span<const sim::Variation> unknowns) {
    MatrixXd result(static_cast<Index>(slopes.size()), static_cast<Index>(unknowns.size()));
    for (std::size_t m = 0; m < slopes.size(); ++m) {
        const auto by = sim::gradient(at, slopes[m], {});
        if (!by) return tl::unexpected(by.error());
        for (std::size_t j = 0; j < unknowns.size(); ++j)
            result(static_cast<Index>(m), static_cast<Index>(j)) =
                by->inputs.dot(unknowns[j].inputs) + by->parameters.dot(unknowns[j].parameters);
    }
    return result;
}

}  // namespace

/// Forward sensitivities for programs with history: the derivative of the state before a piece with respect to each
/// unknown.
struct Trial::Forward {
    explicit Forward(std::vector<sim::History> rest) : by(std::move(rest)) {}

    std::vector<sim::History> by;  ///< (unknowns)

    /// Advances over a piece: (measures, unknowns) at its end.
    [[nodiscard]] Result<MatrixXd> go_on(sim::Linearisation& at, std::span<const sim::Slope> slopes,
                                         std::span<const sim::Variation> unknowns) {
        begin(at);
        MatrixXd result(static_cast<Index>(slopes.size()), static_cast<Index>(unknowns.size()));
        for (std::size_t j = 0; j < unknowns.size(); ++j) {
            sim::Derivative derivative = sim::derivative(at, unknowns[j]);
            const VectorXd force = start_force(at, j);
            const VectorXd free = at.system().restrict_to_free(force.head(by[j].x.size()));
            derivative.equations.head(free.size()) += free;
            derivative.forces.head(force.size()) += force;
            const auto answer = at.response(derivative);
            if (!answer) return tl::unexpected(answer.error());
            result.col(static_cast<Index>(j)) = sim::changes(at, slopes, unknowns[j], derivative, *answer);
            keep(at, j, answer->positions);
        }
        return result;
    }

private:
    /// The change of the forces of a piece with its start.
    [[nodiscard]] VectorXd start_force(const sim::Linearisation& at, std::size_t unknown) const {
        const sim::History& h = by[unknown];
        VectorXd force = VectorXd::Zero(sim::force_size(at.system()));
        if (at.controls().inertia) {
            VectorXd inertia = VectorXd::Zero(h.x.size());
            (void)at.controls().inertia->change(h).evaluate(VectorXd::Zero(h.x.size()), inertia);
            if (const auto damped = sim::damped_step(at))
                sim::add_damping_place_product(*damped, at.controls().inertia->damping_place().of(h), inertia);
            force.head(h.x.size()) += inertia;
            add_joint_force(at, h.x, force);
        }
        VectorXd motion = VectorXd::Zero(force.size());
        motion.head(h.x.size()) = h.x;
        force -= sim::friction_stiffness_times(at.system(), at.state(), at.controls(), motion);
        if (friction_) add_slip_force(at, unknown, force);
        return force;
    }

    /// Joint damping acts against the coordinate at the start of the piece.
    static void add_joint_force(const sim::Linearisation& at, const VectorXd& motion, VectorXd& force) {
        const sim::Equilibrium& system = at.system();
        const auto& joints = system.model().description().joints;
        for (std::size_t j = 0; j < joints.size(); ++j) {
            const double dt = system.joint_drive(at.controls(), j).dt;
            if (!(dt > 0) || !(joints[j].law.damping > 0)) continue;
            VectorXd start = VectorXd::Zero(motion.size()), now = start;
            system.joints()[j].add_coordinate_gradient(linalg::view(at.controls().inertia->start().x), 1,
                                                       linalg::view(start));
            system.joints()[j].add_coordinate_gradient(
                linalg::view(at.state().x), -joints[j].law.damping / dt * start.dot(motion), linalg::view(now));
            force.head(motion.size()) += now;
        }
    }

    /// The end of the previous piece becomes the start of this one.
    void begin(const sim::Linearisation& at) {
        const auto before = std::exchange(friction_, at.controls().friction);
        std::vector<sim::Slips> handed_on = std::exchange(slips_, {});
        const std::size_t pairs = friction_ ? friction_->pairs().size() : 0;
        slips_.assign(by.size(), sim::Slips(pairs, Eigen::Vector2d::Zero()));
        if (!before || !friction_) return;
        for (const auto& carry : sim::contact::find_carries(before->pairs(), friction_->pairs())) {
            for (std::size_t j = 0; j < by.size(); ++j) slips_[j][carry.to] = carry.change * handed_on[j][carry.from];
        }
    }

    void add_slip_force(const sim::Linearisation& at, std::size_t unknown, VectorXd& force) const {
        const std::vector<double> x = sim::contact_nodes(at.system(), at.state(), at.controls());
        sim::Slips resisted = slips_[unknown];
        for (std::size_t k = 0; k < resisted.size(); ++k) resisted[k] = friction_->stiffness(k, x) * resisted[k];
        sim::add_to_forces(at.system(), *friction_, resisted, force);
    }

    /// The slips at the end of the piece, limited to what is carried over; `x`: motion of that end.
    void keep_slips(const sim::Linearisation& at, std::size_t unknown, const VectorXd& x) {
        if (!friction_) return;
        const std::vector<double> end = sim::contact_nodes(at.system(), at.state(), at.controls());
        VectorXd motion = VectorXd::Zero(x.size() + at.controls().obstacles.size());
        motion.head(x.size()) = x - by[unknown].x;
        const sim::Slips moved = sim::slips_of_motion(at.system(), *friction_, motion);
        sim::Slips& slips = slips_[unknown];
        for (std::size_t k = 0; k < slips.size(); ++k) {
            const auto slip = friction_->slip(friction_->pairs()[k], end);
            slips[k] = sim::contact::kept_slip_gradient(slip, friction_->slip_m()) * (slips[k] + moved[k]);
        }
    }

    void keep(const sim::Linearisation& at, std::size_t unknown, const VectorXd& x) {
        keep_slips(at, unknown, x);
        sim::History& h = by[unknown];
        VectorXd v = h.v;
        if (at.controls().inertia && !at.controls().inertia->is_tether())
            v = at.controls().inertia->change(h).velocity(x);
        h.x_before = std::exchange(h.x, x);
        h.v_before = std::exchange(h.v, std::move(v));
    }

    std::shared_ptr<const sim::contact::Friction> friction_{};  ///< of the current piece
    std::vector<sim::Slips> slips_{};  ///< (unknowns) initial slips of its pairs; afterwards, those carried over
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
            values[k] = unknowns[k].clamped(unknowns[k].value_at(unknowns[k].coordinate(at[k]) + step));
            auto variant = source.with(unknowns, values);
            if (!variant && variant.error().cause != Cause::cancelled) {
                // The robot file does not allow this end: the difference is from the state itself.
                values[k] = at[k];
                variant = source.with(unknowns, values);
            }
            if (!variant) return tl::unexpected(variant.error());
            auto numbers = numbers_of(**variant, pieces);
            if (!numbers) return tl::unexpected(numbers.error());
            both.push_back(std::move(*numbers));
            ends.push_back(values[k]);
        }
        values[k] = at[k];
        if (ends[0] == ends[1])
            return failure("{}: the robot file allows no values beside {}", unknowns[k].key, unknowns[k].shown(at[k]));
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
    auto at = sim::Linearisation::create(stepper_->system(), piece.state, piece.controls, piece.pattern);
    if (!at) return tl::unexpected(at.error());
    const std::vector<sim::Slope> slopes = measure_slopes(*at, channels_);
    const std::vector<sim::Variation> unknowns = variations(*at, rates, k);
    Result<MatrixXd> of_measures = MatrixXd(0, 0);
    if (has_history())
        of_measures = forward.go_on(*at, slopes, unknowns);
    else
        of_measures =
            unknowns.size() > slopes.size() ? transposed(*at, slopes, unknowns) : direct(*at, slopes, unknowns);
    if (!of_measures) return of_measures;
    MatrixXd result(static_cast<Index>(channels_.size()), of_measures->cols());
    Index first = 0;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        const auto size = static_cast<Index>(channels_[c].measures.size());
        std::vector<double> values;
        for (Index m = 0; m < size; ++m) values.push_back(slopes[static_cast<std::size_t>(first + m)].value);
        const std::vector<double> by = channels_[c].slopes(values);
        const Eigen::Map<const Eigen::RowVectorXd> row(by.data(), size);
        result.row(static_cast<Index>(c)) = row * of_measures->middleRows(first, size);
        first += size;
    }
    return result;
}

Result<std::vector<MatrixXd>> Trial::slopes(const Source& source, std::span<const Unknown> unknowns,
                                            std::span<const double> at, Progress& progress) const {
    const Result<Rates> by = rates(source, unknowns, at);
    if (!by) return tl::unexpected(by.error());
    const VectorXd nothing = VectorXd::Zero(pieces_.front().state.x.size());
    Forward forward(std::vector<sim::History>(unknowns.size(), {nothing, nothing, nothing, nothing, 0}));
    std::vector<MatrixXd> at_stops(stops_.size());
    // At rest nothing has changed yet.
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

}  // namespace pliant::sim::identify
