#include "simulation/solver/drives.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::sim {
namespace {

/// Energy of an actuator with prescribed multiplier or gas.
double drive_energy(const Drive& drive, const Measured& measure, double ambient_pressure_Pa) {
    switch (drive.kind) {
        case Drive::Kind::measure:
            return 0;
        case Drive::Kind::multiplier:
            return drive.value * measure.now;
        case Drive::Kind::gas:
            // Work of the ambient pressure and of the gas between rest and now, at constant temperature.
            return ambient_pressure_Pa * measure.now - drive.value * std::log(measure.now / measure.rest);
    }
    return 0;
}

}  // namespace

Drive drive_of(const Description& d, std::size_t actuator, double target, double offset, double rest_measure) {
    if (actuator < d.cables.size()) {
        switch (d.cables[actuator].target.kind) {
            case CableTarget::Kind::length_ratio:
                return {Drive::Kind::measure, target * rest_measure + offset};
            case CableTarget::Kind::shortening_m:
                return {Drive::Kind::measure, rest_measure - target + offset};
            case CableTarget::Kind::tension_N:
                return {Drive::Kind::multiplier, std::max(0.0, target + offset)};
        }
    }
    switch (d.chambers[actuator - d.cables.size()].target.kind) {
        case ChamberTarget::Kind::volume_ratio:
            return {Drive::Kind::measure, target * rest_measure + offset};
        case ChamberTarget::Kind::volume_change_m3:
            return {Drive::Kind::measure, rest_measure + target + offset};
        case ChamberTarget::Kind::pressure_Pa:
            return {Drive::Kind::multiplier, -(target + offset)};
        case ChamberTarget::Kind::gas_ratio:
            break;
    }
    return {Drive::Kind::gas, target * d.ambient_pressure_Pa * rest_measure};
}

Drive drive_at(const Description& d, std::size_t actuator, double time, double rest_measure) {
    if (actuator < d.cables.size()) {
        const CableTarget& target = d.cables[actuator].target;
        return drive_of(d, actuator, target.at(time), target.offset_at(time), rest_measure);
    }
    const std::size_t chamber = actuator - d.cables.size();
    if (chamber < d.chambers.size()) {
        const ChamberTarget& target = d.chambers[chamber].target;
        return drive_of(d, actuator, target.at(time), target.offset_at(time), rest_measure);
    }
    const PressureLoad& load = d.pressures[chamber - d.chambers.size()];
    return {Drive::Kind::multiplier, -load.share.at(time) * load.pressure_Pa};
}

double gas_compliance(const Drive& drive, double multiplier, double ambient_pressure_Pa) {
    const double absolute = ambient_pressure_Pa - multiplier;
    return drive.value / (absolute * absolute);  // g = value / (p_ambient - m)
}

void add_drive(const Drive& drive, std::size_t actuator, const Measured& measure, double ambient_pressure_Pa,
               Evaluation& e) {
    const auto i = static_cast<Eigen::Index>(actuator);
    e.energy_J += drive_energy(drive, measure, ambient_pressure_Pa);
    if (drive.kind == Drive::Kind::multiplier) e.multiplier[i] = drive.value;
    if (drive.kind == Drive::Kind::gas) e.multiplier[i] = ambient_pressure_Pa - drive.value / measure.now;
    if (drive.kind != Drive::Kind::measure) return;
    e.constraint_violation[i] = (measure.now - drive.value) / measure.rest;
    const bool slack = measure.only_pulls && !(e.multiplier[i] > 0);
    e.violation = std::max(e.violation, slack ? e.constraint_violation[i] : std::fabs(e.constraint_violation[i]));
}

}  // namespace pliant::sim
