#include "simulation/solver/drives.hpp"

#include <algorithm>

namespace pliant::sim {

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

}  // namespace pliant::sim
