#include "library/simulation/steering.hpp"

namespace pliant::library {
namespace {

const char* unit_of(const sim::CableTarget& target) {
    switch (target.kind) {
        case sim::CableTarget::Kind::shortening_m:
            return "m";
        case sim::CableTarget::Kind::tension_N:
            return "N";
        case sim::CableTarget::Kind::length_ratio:
            break;
    }
    return "";
}

const char* unit_of(const sim::ChamberTarget& target) {
    switch (target.kind) {
        case sim::ChamberTarget::Kind::volume_change_m3:
            return "m^3";
        case sim::ChamberTarget::Kind::pressure_Pa:
            return "Pa";
        case sim::ChamberTarget::Kind::gas_ratio:
        case sim::ChamberTarget::Kind::volume_ratio:
            break;
    }
    return "";
}

}  // namespace

std::vector<SteeredInput> steered_inputs(const sim::Model& model, const sim::InverseTask& task) {
    const sim::Description& d = model.description();
    std::vector<SteeredInput> inputs;
    for (const sim::Steered& one : task.inputs) {
        const std::size_t a = one.actuator, cables = d.cables.size();
        const char* unit = a < cables ? unit_of(d.cables[a].target) : unit_of(d.chambers[a - cables].target);
        inputs.push_back({one.name, unit, one.low, one.high});
    }
    return inputs;
}

Inputs inputs_at(const sim::Equilibrium& system, const sim::InverseTask& task, std::span<const double> values,
                 double time) {
    sim::Inputs inputs{time, system.controls(time).drives};
    inputs.drives.resize(system.model().description().steered_count());  // pressure loads follow the program
    for (std::size_t i = 0; i < values.size(); ++i)
        inputs.drives[task.inputs[i].actuator] = system.drive(task.inputs[i].actuator, values[i]);
    return inputs_of(system.model(), inputs);
}

}  // namespace pliant::library
