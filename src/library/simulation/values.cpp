#include <fmt/format.h>

#include <cmath>

#include "base/core/files.hpp"
#include "base/linalg/vectors.hpp"
#include "library/base/calls.hpp"
#include "library/simulation/data.hpp"
#include "simulation/stepper/state_file.hpp"

namespace pliant {
namespace {

using By = Drive::By;
using DriveKind = sim::Drive::Kind;

/// A chamber's multiplier is minus its pressure.
Drive drive_of(const sim::Drive& drive, bool cable) {
    switch (drive.kind) {
        case DriveKind::measure:
            return {cable ? By::length : By::volume, drive.value};
        case DriveKind::multiplier:
            return {cable ? By::tension : By::pressure, cable ? drive.value : 0 - drive.value};
        case DriveKind::gas:
            break;
    }
    return {By::gas, drive.value};
}

sim::Drive drive_for(const Drive& drive, const std::string& name, bool cable) {
    const auto wrong = [&](const std::string& why) {
        throw Failure(Failure::Kind::input, fmt::format("{} \"{}\": {}", cable ? "cable" : "chamber", name, why));
    };
    if (!std::isfinite(drive.value)) wrong("driven by a number that is not finite");
    const bool of_cable = drive.by == By::length || drive.by == By::tension;
    if (of_cable != cable) wrong(cable ? "is driven by length or tension" : "is driven by volume, pressure or gas");
    const bool positive = drive.by != By::tension && drive.by != By::pressure;
    if (positive ? !(drive.value > 0) : cable && !(drive.value >= 0)) {
        const char* what = drive.by == By::length    ? "a length"
                           : drive.by == By::tension ? "a tension"
                           : drive.by == By::volume  ? "a volume"
                                                     : "an amount of gas";
        const char* unit = drive.by == By::length    ? "m"
                           : drive.by == By::tension ? "N"
                           : drive.by == By::volume  ? "m^3"
                                                     : "J";
        wrong(fmt::format("{} of {:g} {} is not possible: it must {}{}", what, drive.value, unit,
                          positive ? "be above 0" : "not be negative",
                          drive.by == By::length ? "; a shortening in metres is less than the cable's length" : ""));
    }
    if (drive.by == By::length || drive.by == By::volume) return {DriveKind::measure, drive.value};
    if (drive.by == By::gas) return {DriveKind::gas, drive.value};
    return {DriveKind::multiplier, cable ? drive.value : -drive.value};
}

/// Nothing is below a vacuum.
void check_vacuum(const Drive& drive, const std::string& chamber, double ambient_Pa) {
    if (drive.by == By::pressure && drive.value < -ambient_Pa)
        throw Failure(
            Failure::Kind::input,
            fmt::format("chamber \"{}\": a pressure of {:.6g} kPa is below a vacuum: the air around has {:.6g} "
                        "kPa (program.ambient_pressure)",
                        chamber, 1e-3 * drive.value, 1e-3 * ambient_Pa));
}

}  // namespace

namespace library {

std::vector<Point> points_of(std::span<const Vec3> points) {
    std::vector<Point> out;
    out.reserve(points.size());
    for (const Vec3& p : points) out.push_back({p.x, p.y, p.z});
    return out;
}

std::span<const double> numbers_of(std::span<const Vec3> points) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    return points.empty() ? std::span<const double>{} : std::span{&points.data()->x, 3 * points.size()};
}

Inputs inputs_of(const sim::Model& model, const sim::Inputs& inputs) {
    Inputs out;
    out.time = inputs.time;
    const std::size_t cables = model.description().cables.size();
    for (std::size_t a = 0; a < inputs.drives.size(); ++a)
        (a < cables ? out.cables : out.chambers).push_back(drive_of(inputs.drives[a], a < cables));
    return out;
}

sim::Inputs inputs_for(const sim::Model& model, const Inputs& inputs) {
    const sim::Description& d = model.description();
    if (!std::isfinite(inputs.time)) throw Failure(Failure::Kind::input, "the time is not finite");
    if (inputs.cables.size() != d.cables.size() || inputs.chambers.size() != d.chambers.size())
        throw Failure(Failure::Kind::input,
                      fmt::format("the inputs drive {} cables and {} chambers; the robot has {} and {}",
                                  inputs.cables.size(), inputs.chambers.size(), d.cables.size(), d.chambers.size()));
    sim::Inputs out{inputs.time, {}};
    for (std::size_t c = 0; c < d.cables.size(); ++c)
        out.drives.push_back(drive_for(inputs.cables[c], d.cables[c].name, true));
    for (std::size_t c = 0; c < d.chambers.size(); ++c) {
        check_vacuum(inputs.chambers[c], d.chambers[c].name, d.ambient_pressure_Pa);
        out.drives.push_back(drive_for(inputs.chambers[c], d.chambers[c].name, false));
    }
    return out;
}

std::vector<double> list_of(const Eigen::VectorXd& numbers) {
    return {numbers.begin(), numbers.end()};
}

std::vector<Parameter> parameters_of(const std::vector<sim::Parameter>& all) {
    std::vector<Parameter> out;
    for (const sim::Parameter& one : all) out.push_back({one.name, one.unit, one.value});
    return out;
}

StepResult result_of(const sim::Step& step) {
    return {true, !step.converged, step.reason, step.iterations, step.substeps, step.residual};
}

Observation observation_of(const sim::Step& step) {
    const auto point = [](const Vec3& v) { return Point{v.x, v.y, v.z}; };
    Observation seen;
    for (const auto& c : step.cables) seen.cables.push_back({c.name, c.length_m, c.length_ratio, c.tension_N});
    for (const auto& c : step.chambers) seen.chambers.push_back({c.name, c.volume_m3, c.volume_ratio, c.pressure_Pa});
    for (const auto& s : step.springs) seen.springs.push_back({s.name, s.length_m, s.force_N});
    for (const auto& m : step.markers) seen.markers.push_back({m.name, point(m.position_m)});
    for (const auto& s : step.supports) seen.supports.push_back({s.name, point(s.force_N)});
    for (const auto& c : step.contacts) seen.contacts.push_back({c.name, point(c.force_N)});
    for (const auto& s : step.sensors) {
        seen.sensors.push_back({s.name, {}});
        for (const sim::Reading& r : s.readings)
            seen.sensors.back().readings.push_back({r.name, std::string(sim::shown(r.quantity).si_unit), r.value});
    }
    for (const auto& j : step.joints)
        seen.joints.push_back({j.name, point(j.force_N), point(j.torque_Nm), j.coordinate, j.effort});
    for (const auto& o : step.objects)
        seen.objects.push_back({o.name, point(o.position_m), o.rotation, point(o.force_N)});
    seen.self_contact_N = step.self_contact_N;
    seen.smallest_distance_m = step.smallest_distance_m;
    seen.energy_J = step.energy_J;
    seen.kinetic_energy_J = step.kinetic_energy_J;
    seen.min_J = step.min_J;
    return seen;
}

}  // namespace library

State::State(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

std::vector<Point> State::positions() const {
    return library::points_of(linalg::points_of(data_->robot.x()));
}

std::span<const double> State::coordinates() const {
    const Eigen::VectorXd& x = data_->robot.x();
    return {x.data(), static_cast<std::size_t>(x.size())};
}

std::vector<Point> State::velocities() const {
    const Eigen::VectorXd& v = data_->robot.history.v;
    return library::points_of(
        linalg::points_of(v.size() > 0 ? v : Eigen::VectorXd(Eigen::VectorXd::Zero(data_->robot.x().size()))));
}

Inputs State::inputs() const {
    return library::inputs_of(data_->model->scene.model, data_->robot.inputs);
}

std::string State::bytes() const {
    return sim::state_bytes(data_->model->scene.model, data_->robot);
}

void State::save(const std::filesystem::path& file) const {
    library::check(write_file(file, bytes()));
}

bool operator==(const State& a, const State& b) {
    return a.data_ == b.data_ || a.bytes() == b.bytes();
}

}  // namespace pliant
