#include "simulation/identify/trial.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulation/run/simulate.hpp"

namespace pliant::sim::identify {

Trial::Trial(std::unique_ptr<Variant> variant, std::span<const Channel> channels)
    : variant_(std::move(variant)),
      channels_(channels.begin(), channels.end()),
      stepper_(std::make_unique<sim::Stepper>(variant_->model, sim::stepper_options(variant_->program))) {}

bool Trial::has_history() const {
    return stepper_->has_inertia() || stepper_->system().has_friction();
}

void Trial::plan(std::span<const double> times) {
    const robot::Program& program = variant_->program;
    const double rounding = 1e-9 * program.duration;
    const double last = times.empty() ? 0 : *std::ranges::max_element(times);
    stops_ = {0};
    for (int k = 1; k <= program.steps; ++k) {
        stops_.push_back(program.duration * k / program.steps);
        if (stops_.back() >= last - rounding) break;
    }
    if (!has_history()) {
        stops_.insert(stops_.end(), times.begin(), times.end());
        std::ranges::sort(stops_);
        const auto same = [&](double a, double b) { return b - a < rounding; };
        stops_.erase(std::unique(stops_.begin(), stops_.end(), same), stops_.end());
    }
    for (const double time : times) {
        const auto found = std::ranges::lower_bound(stops_, time - rounding);
        const auto after = static_cast<std::size_t>(std::min(found, stops_.end() - 1) - stops_.begin());
        const bool there = std::fabs(stops_[after] - time) <= rounding || after == 0;
        const std::size_t before = there ? after : after - 1;
        places_.push_back({before, after, there ? 0 : (time - stops_[before]) / (stops_[after] - stops_[before])});
    }
}

Status Trial::run(Progress& progress) {
    const bool history = has_history();
    const auto keep = [&](int stop, const sim::RobotState& at) {
        pieces_.push_back({stop, at.now.state, at.controls,
                           sim::known_pattern(stepper_->system(), stepper_->laplacian(), at.memory.get())});
    };
    const double shortest = variant_->program.duration / variant_->program.steps / 64;
    sim::RobotState robot = stepper_->rest();
    pieces_.push_back({0, robot.now.state, stepper_->controls(robot, 0)});
    std::vector<bool> needed(stops_.size(), history);
    for (const Place& place : places_) needed[place.before] = needed[place.after] = true;
    for (std::size_t k = 1; k < stops_.size(); ++k) {
        if (progress.cancelled()) return cancelled();
        progress.advance("trial", static_cast<double>(k) / static_cast<double>(stops_.size()));
        sim::StepPath path{stops_[k], [&](double time) { return stepper_->controls(robot, time); }, shortest};
        if (history) path.after_piece = [&](const sim::RobotState& at) { keep(-1, at); };
        const sim::StepReport report = stepper_->step(robot, path, progress);
        if (progress.cancelled()) return cancelled();
        if (!report.arrived) return failure("stopped at time {:.4g}: {}", stops_[k], report.reason);
        if (!history && needed[k]) keep(0, robot);
        if (needed[k]) pieces_.back().stop = static_cast<int>(k);
    }
    return {};
}

Eigen::VectorXd Trial::channel_values(const Piece& piece) const {
    Eigen::VectorXd values(static_cast<Eigen::Index>(channels_.size()));
    std::vector<double> of;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        of.clear();
        for (const sim::Measure& measure : channels_[c].measures)
            of.push_back(sim::slope(stepper_->system(), piece.state, piece.controls, measure).value);
        values[static_cast<Eigen::Index>(c)] = channels_[c].value(of);
    }
    return values;
}

void Trial::keep_values() {
    Eigen::MatrixXd at_stops(static_cast<Eigen::Index>(stops_.size()), static_cast<Eigen::Index>(channels_.size()));
    for (const Piece& piece : pieces_) {
        if (piece.stop >= 0) at_stops.row(piece.stop) = channel_values(piece);
    }
    values_.resize(static_cast<Eigen::Index>(places_.size()), at_stops.cols());
    for (std::size_t t = 0; t < places_.size(); ++t) {
        const Place& place = places_[t];
        values_.row(static_cast<Eigen::Index>(t)) =
            (1 - place.share) * at_stops.row(static_cast<Eigen::Index>(place.before)) +
            place.share * at_stops.row(static_cast<Eigen::Index>(place.after));
    }
}

Result<std::unique_ptr<Trial>> Trial::solve(std::unique_ptr<Variant> variant, std::span<const Channel> channels,
                                            std::span<const double> times, Progress& progress) {
    std::unique_ptr<Trial> trial(new Trial(std::move(variant), channels));
    for (const Channel& channel : channels) {
        for (const sim::Measure& measure : channel.measures) {
            if (Status status = sim::check(trial->stepper_->system(), measure); !status)
                return tl::unexpected(status.error());
        }
    }
    trial->plan(times);
    if (Status status = trial->run(progress); !status) return tl::unexpected(status.error());
    trial->keep_values();
    return trial;
}

}  // namespace pliant::sim::identify
