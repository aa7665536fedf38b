#include "presentation/report/tables.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <numbers>

#include "base/core/csv.hpp"
#include "simulation/run/result_columns.hpp"

namespace pliant::report {
namespace {

/// Builds one line; inserts separators.
class Row {
public:
    void text(std::string_view value) { add(csv_field(value)); }
    void number(double value) { add(fmt::format("{:.10g}", value)); }
    void number(int value) { add(fmt::format("{}", value)); }
    void vector(const Vec3& v, double factor) {
        for (std::size_t i = 0; i < 3; ++i) number(factor * v[i]);
    }
    [[nodiscard]] std::string line() const { return line_ + "\n"; }

private:
    void add(const std::string& field) {
        if (!line_.empty()) line_ += ',';
        line_ += field;
    }
    std::string line_;
};

void names(Row& row, const std::string& name, std::span<const std::string_view> columns) {
    for (const std::string_view column : columns) row.text(fmt::format("{}_{}", name, column));
}

std::string steps_header(const sim::Step& rest, bool contact) {
    namespace columns = sim::columns;
    static constexpr std::array<std::string_view, 9> common = {
        "index", "time", "converged", "iterations", "substeps", "residual", "wall_ms", "min_J", "solver"};
    Row row;
    for (const std::string_view name : common) row.text(name);
    for (const auto& c : rest.cables) names(row, c.name, columns::cable);
    for (const auto& c : rest.chambers) names(row, c.name, columns::chamber);
    for (const auto& s : rest.springs) names(row, s.name, columns::spring);
    for (const auto& s : rest.supports) names(row, s.name, columns::force);
    for (const auto& o : rest.contacts) names(row, o.name, columns::force);
    for (const auto& o : rest.objects) names(row, o.name, columns::object);
    for (const auto& j : rest.joints) {
        names(row, j.name, columns::joint);
        if (j.turns || j.slides) names(row, j.name, j.turns ? columns::turning : columns::sliding);
    }
    for (const auto& sensor : rest.sensors) {
        for (const sim::Reading& r : sensor.readings)
            row.text(fmt::format("{}_{}{}", sensor.name, r.name, sim::shown(r.quantity).suffix));
    }
    if (contact) {
        row.text("self_contact_N");
        row.text("smallest_distance_mm");
    }
    return row.line();
}

std::string steps_row(const sim::Step& step, bool contact) {
    Row row;
    row.number(step.index);
    row.number(step.time);
    row.number(step.converged ? 1 : 0);
    row.number(step.iterations);
    row.number(step.substeps);
    row.number(step.residual);
    row.number(1e3 * step.wall_s);
    row.number(step.min_J);
    row.text(step.index == 0 ? "" : sim::name(step.solver));
    for (const auto& c : step.cables) {
        row.number(c.length_ratio);
        row.number(1e3 * c.length_m);
        row.number(c.tension_N);
    }
    for (const auto& c : step.chambers) {
        row.number(c.volume_ratio);
        row.number(1e9 * c.volume_m3);
        row.number(1e-3 * c.pressure_Pa);
    }
    for (const auto& s : step.springs) {
        row.number(1e3 * s.length_m);
        row.number(s.force_N);
    }
    for (const auto& s : step.supports) row.vector(s.force_N, 1);
    for (const auto& o : step.contacts) row.vector(o.force_N, 1);
    for (const auto& o : step.objects) {
        row.vector(o.position_m, 1e3);
        for (const double q : o.rotation) row.number(q);
        row.vector(o.force_N, 1);
    }
    for (const auto& j : step.joints) {
        row.vector(j.force_N, 1);
        row.vector(j.torque_Nm, 1);
        if (!j.turns && !j.slides) continue;
        row.number(j.turns ? 180 / std::numbers::pi * j.coordinate : 1e3 * j.coordinate);
        row.number(j.effort);
    }
    for (const auto& sensor : step.sensors) {
        for (const sim::Reading& r : sensor.readings) row.number(sim::shown(r.quantity).factor * r.value);
    }
    if (contact) {
        row.number(step.self_contact_N);
        if (std::isfinite(step.smallest_distance_m))
            row.number(1e3 * step.smallest_distance_m);
        else
            row.text("");
    }
    return row.line();
}

}  // namespace

std::string steps_csv(const sim::Trajectory& result) {
    const bool contact = has_contact(result);
    std::string out = steps_header(result.steps.front(), contact);
    for (const sim::Step& step : result.steps) out += steps_row(step, contact);
    return out;
}

std::string markers_csv(const sim::Trajectory& result) {
    static constexpr std::array<std::string_view, 3> axes = {"x_mm", "y_mm", "z_mm"};
    Row header;
    header.text("index");
    header.text("time");
    for (const auto& marker : result.steps.front().markers) names(header, marker.name, axes);
    std::string out = header.line();
    for (const sim::Step& step : result.steps) {
        Row row;
        row.number(step.index);
        row.number(step.time);
        for (const auto& marker : step.markers) row.vector(marker.position_m, 1e3);
        out += row.line();
    }
    return out;
}

std::string iteration_row(const sim::IterationRecord& r) {
    return fmt::format("{},{:.10g},{},{},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g}", r.step, r.time, sim::name(r.solver),
                       r.iteration, r.residual, r.violation, r.energy_J, r.alpha, r.min_J);
}

std::string iterations_csv(const sim::Trajectory& result) {
    std::string out = "step,time,solver,iteration,residual,violation,energy_J,alpha,min_J\n";
    for (const sim::IterationRecord& record : result.iterations) out += iteration_row(record) + "\n";
    return out;
}

}  // namespace pliant::report
