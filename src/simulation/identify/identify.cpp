#include "simulation/identify/identify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "base/core/text.hpp"
#include "base/linalg/dense.hpp"
#include "simulation/identify/at_bounds.hpp"
#include "simulation/identify/confidence.hpp"
#include "simulation/identify/least_squares.hpp"
#include "simulation/identify/trial.hpp"

namespace pliant::sim::identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Default scatter of a unit: this share of the largest motion of a quantity in that unit.
constexpr double share_of_motion = 0.01;
/// Smaller effects on all residuals together count as none, in units of scatter.
constexpr double negligible = 1e-6;
constexpr double longest_step = 1.5;  // of log(value): a factor of 4.5

std::vector<double> times_of(const std::vector<MeasuredValue>& values) {
    std::vector<double> times;
    for (const MeasuredValue& value : values) times.push_back(value.time);
    std::ranges::sort(times);
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

/// How far the quantity that moves most in a unit moves, measured from the lowest value to the highest, rest included.
/// Held-out values have no part in it: they must not change the fit that they judge.
std::map<std::string, double> motions(const Measurements& m, const VectorXd& rest) {
    std::vector<std::pair<double, double>> range;
    for (std::size_t c = 0; c < m.channels.size(); ++c)
        range.emplace_back(rest[static_cast<Index>(c)], rest[static_cast<Index>(c)]);
    for (const MeasuredValue& value : m.values) {
        if (value.judged) continue;
        auto& [low, high] = range[value.channel];
        low = std::min(low, value.value);
        high = std::max(high, value.value);
    }
    std::map<std::string, double> motion;
    for (std::size_t c = 0; c < m.channels.size(); ++c) {
        double& largest = motion[m.channels[c].unit];
        largest = std::max(largest, range[c].second - range[c].first);
    }
    return motion;
}

/// The scatter of each value: its own, else that of its unit.
VectorXd scatters_of(const Measurements& m, const VectorXd& rest) {
    const std::map<std::string, double> motion = motions(m, rest);
    VectorXd scatters(static_cast<Index>(m.values.size()));
    for (std::size_t k = 0; k < m.values.size(); ++k) {
        const double whole = motion.at(m.channels[m.values[k].channel].unit);
        scatters[static_cast<Index>(k)] =
            m.values[k].scatter > 0 ? m.values[k].scatter : share_of_motion * (whole > 0 ? whole : 1);
    }
    return scatters;
}

class Search {
public:
    Search(const Source& source, const std::vector<Unknown>& unknowns, const Measurements& measurements,
           Progress& progress)
        : source_(source), unknowns_(unknowns), m_(measurements), progress_(progress), times_(times_of(m_.values)) {
        for (std::size_t k = 0; k < m_.values.size(); ++k) {
            if (!m_.values[k].judged) fitted_.push_back(k);
        }
    }

    [[nodiscard]] Result<Identification> run() {
        if (Status status = check(); !status) return tl::unexpected(status.error());
        VectorXd start(static_cast<Index>(unknowns_.size())), low = start, high = start;
        for (std::size_t k = 0; k < unknowns_.size(); ++k) {
            const auto j = static_cast<Index>(k);
            start[j] = unknowns_[k].coordinate(unknowns_[k].value);
            low[j] = unknowns_[k].coordinate(unknowns_[k].low);
            high[j] = unknowns_[k].coordinate(unknowns_[k].high);
        }
        const LeastSquaresProblem problem{[&](const VectorXd& u) { return residuals(u); }, [&] { return jacobian(); },
                                          low, high, longest_step};
        const auto end = minimise(problem, start);
        if (!end) return tl::unexpected(end.error());
        return conclude(*end, low, high);
    }

private:
    [[nodiscard]] Status check() const {
        if (unknowns_.empty()) return input_error("there is nothing to find; name an unknown");
        for (std::size_t k = 0; k < unknowns_.size(); ++k) {
            for (std::size_t other = 0; other < k; ++other) {
                if (unknowns_[other].key == unknowns_[k].key)
                    return input_error("{}: is named twice", unknowns_[k].key);
            }
        }
        if (fitted_.size() < unknowns_.size())
            return input_error("{}: {} measured values cannot give {} unknowns", m_.file, fitted_.size(),
                               unknowns_.size());
        return {};
    }

    [[nodiscard]] std::vector<double> values_at(const VectorXd& u) const {
        std::vector<double> values;
        // A bound may be the last value that the robot file allows: rounding must not go beyond it.
        for (std::size_t k = 0; k < unknowns_.size(); ++k)
            values.push_back(unknowns_[k].clamped(unknowns_[k].value_at(u[static_cast<Index>(k)])));
        return values;
    }

    [[nodiscard]] Index row_of(double time) const { return std::ranges::lower_bound(times_, time) - times_.begin(); }

    /// A failure at the start is an error with its reason; later ones only reject the trial.
    [[nodiscard]] Result<std::optional<VectorXd>> residuals(const VectorXd& u) {
        auto variant = source_.with(unknowns_, values_at(u));
        if (!variant && (!best_ || variant.error().cause == Cause::cancelled)) return tl::unexpected(variant.error());
        if (!variant) {
            refused_ = variant.error().message;
            return std::nullopt;
        }
        auto trial = Trial::solve(std::move(*variant), m_.channels, times_, progress_);
        if (!trial && (!best_ || trial.error().cause != Cause::failed)) return tl::unexpected(trial.error());
        if (!trial) return std::nullopt;
        if (!best_) scatters_ = scatters_of(m_, (*trial)->rest());
        VectorXd r(static_cast<Index>(fitted_.size()));
        for (std::size_t k = 0; k < fitted_.size(); ++k) {
            const MeasuredValue& value = m_.values[fitted_[k]];
            const double simulated = (*trial)->values()(row_of(value.time), static_cast<Index>(value.channel));
            r[static_cast<Index>(k)] = (simulated - value.value) / scatters_[static_cast<Index>(fitted_[k])];
        }
        if (!r.allFinite()) return std::nullopt;
        if (!best_) before_ = (*trial)->values();
        if (!best_ || r.squaredNorm() < least_) {
            least_ = r.squaredNorm();
            best_ = std::move(*trial);
            best_u_ = u;
        }
        return r;
    }

    [[nodiscard]] Result<MatrixXd> jacobian() {
        const auto slopes = best_->slopes(source_, unknowns_, values_at(best_u_), progress_);
        if (!slopes) return tl::unexpected(slopes.error());
        MatrixXd J(static_cast<Index>(fitted_.size()), static_cast<Index>(unknowns_.size()));
        for (std::size_t k = 0; k < fitted_.size(); ++k) {
            const MeasuredValue& value = m_.values[fitted_[k]];
            J.row(static_cast<Index>(k)) =
                (*slopes)[static_cast<std::size_t>(row_of(value.time))].row(static_cast<Index>(value.channel)) /
                scatters_[static_cast<Index>(fitted_[k])];
        }
        return J;
    }

    [[nodiscard]] std::vector<Errors> errors(const std::vector<Compared>& values, bool judged) const {
        std::vector<Errors> all;
        for (const Compared& value : values) {
            if (value.measured.judged != judged) continue;
            const std::string& unit = m_.channels[value.measured.channel].unit;
            auto of = std::ranges::find(all, unit, &Errors::unit);
            if (of == all.end()) of = all.insert(all.end(), {unit});
            ++of->values;
            of->before += std::pow(value.before - value.measured.value, 2);
            of->after += std::pow(value.after - value.measured.value, 2);
        }
        for (Errors& of : all) {
            of.before = std::sqrt(of.before / static_cast<double>(of.values));
            of.after = std::sqrt(of.after / static_cast<double>(of.values));
        }
        return all;
    }

    /// At a bound exactly the bound, without the rounding of its scale.
    [[nodiscard]] static double value_of(const Unknown& unknown, double u, bool at_bound) {
        const double value = unknown.value_at(u);
        if (!at_bound) return std::clamp(value, unknown.low, unknown.high);
        return value - unknown.low < unknown.high - value ? unknown.low : unknown.high;
    }

    /// A number that may be 0 has an interval in itself, not in its coordinate, which bends within the interval.
    [[nodiscard]] static double moved(const Unknown& unknown, double u, double by) {
        const double value = unknown.value_at(u);
        return unknown.scale == Scale::from_zero ? value + unknown.rate(value) * by : unknown.value_at(u + by);
    }

    /// Far from its start a coordinate bends within an interval from a bound: there the value itself is the coordinate,
    /// in units of what a change of 1 in u is at the start.
    [[nodiscard]] static double unit_at_bound(const Unknown& unknown) { return unknown.rate(unknown.value); }

    /// The derivatives with respect to the coordinates of bounds for those that are held.
    [[nodiscard]] MatrixXd at_bounds_jacobian(const LeastSquaresEnd& end, const std::vector<bool>& held) const {
        MatrixXd J = end.jacobian;
        for (std::size_t k = 0; k < held.size(); ++k) {
            const auto j = static_cast<Index>(k);
            const Unknown& unknown = unknowns_[k];
            if (held[k]) J.col(j) *= unit_at_bound(unknown) / unknown.rate(value_of(unknown, end.u[j], true));
        }
        return J;
    }

    [[nodiscard]] std::vector<End> ends(const VectorXd& u, const std::vector<bool>& held) const {
        std::vector<End> all;
        for (std::size_t k = 0; k < held.size(); ++k) {
            const Unknown& unknown = unknowns_[k];
            const bool is_low = value_of(unknown, u[static_cast<Index>(k)], held[k]) == unknown.low;
            const double room = (unknown.high - unknown.low) / unit_at_bound(unknown);
            all.push_back(held[k] ? End{is_low ? 1 : -1, room} : End{});
        }
        return all;
    }

    /// Sets the interval from `below` under u to `above` over it. No formula knows the bounds, between which the value
    /// is known to be.
    static void set_interval(Found& found, double u, double below, double above) {
        if (!std::isfinite(below) || !std::isfinite(above)) return;
        const auto& [lowest, highest] = std::pair(found.unknown.low, found.unknown.high);
        found.low = std::clamp(moved(found.unknown, u, -below), lowest, highest);
        found.high = std::clamp(moved(found.unknown, u, above), lowest, highest);
    }

    void find(const LeastSquaresEnd& end, const Confidence& known, const std::vector<End>& ends, const AtBounds& open,
              Identification& result) const {
        for (std::size_t k = 0; k < unknowns_.size(); ++k) {
            const auto j = static_cast<Index>(k);
            const int inward = ends[k].inward;
            const double u = end.u[j], reach = open.reach[j];
            Found found{unknowns_[k], value_of(unknowns_[k], u, inward != 0), {}, {}, inward != 0, known.matters[k]};
            if (inward == 0) {
                set_interval(found, u, known.half_width[j] + open.below[j], known.half_width[j] + open.above[j]);
            } else if (reach > 0) {
                const double other = found.unknown.clamped(found.value + inward * reach * unit_at_bound(found.unknown));
                found.low = std::min(found.value, other);
                found.high = std::max(found.value, other);
            }
            result.found.push_back(std::move(found));
        }
    }

    /// A group of the fitted values with noise of its own: a unit, with scatters that are given or not.
    [[nodiscard]] int group_of(const MeasuredValue& value) const {
        const auto same = std::ranges::find(m_.channels, m_.channels[value.channel].unit, &Channel::unit);
        return static_cast<int>(2 * (same - m_.channels.begin())) + (value.scatter > 0 ? 1 : 0);
    }

    [[nodiscard]] std::vector<int> groups() const {
        std::vector<int> all;
        for (const std::size_t k : fitted_) all.push_back(group_of(m_.values[k]));
        return all;
    }

    void warn_of_noise(const Confidence& known, Identification& result) const {
        if (fitted_.size() == unknowns_.size()) return;
        for (const int group : known.unclear) {
            const std::string& unit = m_.channels[static_cast<std::size_t>(group / 2)].unit;
            result.warnings.push_back(
                fmt::format("the values in {} are too few to show their noise, so some intervals are missing; measure "
                            "more of them",
                            unit.empty() ? "ratios" : unit));
        }
    }

    /// The search cannot go where the robot file allows no values, and those may be what the data ask for.
    void warn_of_refusal(const LeastSquaresEnd& end, const std::vector<bool>& held, Identification& result) const {
        if (refused_.empty()) return;
        constexpr double notable = 1e-6, far = 1e-3;  // of the sum of squares; of a coordinate
        MatrixXd J = end.jacobian;
        for (std::size_t k = 0; k < held.size(); ++k)
            if (held[k]) J.col(static_cast<Index>(k)).setZero();
        const VectorXd step = linalg::pseudo_inverse(J) * -end.residuals;
        const double now = end.residuals.squaredNorm();
        if (!(step.cwiseAbs().maxCoeff() > far)) return;
        if (!(now - (end.residuals + J * step).squaredNorm() > notable * now)) return;
        result.warnings.push_back(
            "the data ask for values that the robot file does not allow, and the search ended before them: " +
            refused_);
    }

    /// With an interval: within it the bound explains the data as well as a value beyond it.
    [[nodiscard]] static std::string at_bound_warning(const Found& found) {
        const bool from_below = *found.low == found.value;
        return fmt::format(
            "{}: is at its bound, {}; the data ask for a value beyond it, and within their noise allow {} {}",
            found.unknown.key, found.unknown.shown(found.value), from_below ? "up to" : "down to",
            found.unknown.shown(from_below ? *found.high : *found.low));
    }

    void warn(const Confidence& known, const AtBounds& open, Identification& result) const {
        for (const Found& found : result.found) {
            if (!found.matters)
                result.warnings.push_back(fmt::format(
                    "{}: nothing that was measured depends on it; its value means nothing", found.unknown.key));
            else if (found.at_bound && found.low)
                result.warnings.push_back(at_bound_warning(found));
            else if (found.at_bound)
                result.warnings.push_back(fmt::format("{}: is at its bound, {}; the data ask for a value beyond it",
                                                      found.unknown.key, found.unknown.shown(found.value)));
            else if (found.low && *found.low <= found.unknown.low && *found.high >= found.unknown.high)
                result.warnings.push_back(fmt::format(
                    "{}: these data hardly determine it: its interval reaches from bound to bound", found.unknown.key));
        }
        std::vector<std::vector<std::size_t>> mixed = known.mixed;
        mixed.insert(mixed.end(), open.mixed.begin(), open.mixed.end());
        for (const auto& group : mixed) {
            std::vector<std::string> names;
            for (const std::size_t k : group) names.push_back(unknowns_[k].key);
            result.warnings.push_back(fmt::format(
                "{} cannot be told apart with these data: a change of one looks like a change of the other{}; "
                "fix {} or measure something else",
                join_names(names), names.size() > 2 ? "s" : "", names.size() > 2 ? "some" : "one"));
        }
        warn_of_noise(known, result);
        if (fitted_.size() == unknowns_.size())
            result.warnings.emplace_back("as many unknowns as measured values: how well they are known cannot be told");
        if (!result.converged)
            result.warnings.push_back(
                fmt::format("the search stopped after {} trials, before it converged", result.trials));
    }

    [[nodiscard]] Identification conclude(const LeastSquaresEnd& end, const VectorXd& low, const VectorXd& high) const {
        const VectorXd gradient = end.jacobian.transpose() * end.residuals;
        std::vector<bool> held;
        for (Index j = 0; j < end.u.size(); ++j)
            held.push_back((end.u[j] <= low[j] && gradient[j] > 0) || (end.u[j] >= high[j] && gradient[j] < 0));
        const MatrixXd J = at_bounds_jacobian(end, held);
        const Confidence known = confidence(J, end.residuals, held, negligible, groups());
        Identification result;
        result.trials = end.trials;
        result.converged = end.converged;
        result.correlation = known.correlation;
        result.channels = m_.channels;
        const std::vector<End> where = ends(end.u, held);
        const AtBounds open = at_bounds(J, end.residuals, where, negligible, groups());
        find(end, known, where, open, result);
        for (const MeasuredValue& value : m_.values) {
            const auto channel = static_cast<Index>(value.channel);
            const Index row = row_of(value.time);
            result.values.push_back({value, before_(row, channel), best_->values()(row, channel)});
        }
        result.fitted = errors(result.values, false);
        result.judged = errors(result.values, true);
        warn(known, open, result);
        warn_of_refusal(end, held, result);
        if (!m_.not_compared.empty())
            result.warnings.push_back(fmt::format(
                "{}: {} of the table {} not compared: readings of sensors, and what belongs to objects and joints, "
                "are no measurements here",
                m_.file, join_names(m_.not_compared), m_.not_compared.size() > 1 ? "are" : "is"));
        return result;
    }

    const Source& source_;
    const std::vector<Unknown>& unknowns_;
    const Measurements& m_;
    Progress& progress_;
    std::vector<double> times_;
    VectorXd scatters_;                ///< (values)
    std::vector<std::size_t> fitted_;  ///< places in the values
    std::unique_ptr<Trial> best_;
    VectorXd best_u_;
    double least_ = std::numeric_limits<double>::infinity();
    MatrixXd before_;      ///< (times, channels)
    std::string refused_;  ///< why the robot file does not allow the values of the last trial that it refused
};

}  // namespace

Result<Identification> identify(const Source& source, const std::vector<Unknown>& unknowns,
                                const Measurements& measurements, Progress& progress) {
    return Search(source, unknowns, measurements, progress).run();
}

std::vector<std::string> assignments(const Identification& result) {
    std::vector<std::string> all;
    for (const Found& found : result.found) all.push_back(found.unknown.assignment(found.value));
    return all;
}

}  // namespace pliant::sim::identify
