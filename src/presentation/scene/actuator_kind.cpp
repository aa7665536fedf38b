#include "presentation/scene/actuator_kind.hpp"

namespace pliant::view {

ActuatorKind kind_of(const sim::CableTarget& target) {
    using Kind = sim::CableTarget::Kind;
    switch (target.kind) {
        case Kind::shortening_m:
            return {"shortening_mm", 1e3};
        case Kind::tension_N:
            return {"tension_N"};
        case Kind::length_ratio:
            break;
    }
    return {"length_ratio"};
}

ActuatorKind kind_of(const sim::ChamberTarget& target) {
    using Kind = sim::ChamberTarget::Kind;
    switch (target.kind) {
        case Kind::volume_change_m3:
            return {"volume_change_mm3", 1e9};
        case Kind::pressure_Pa:
            return {"pressure_kPa", 1e-3};
        case Kind::gas_ratio:
            return {"gas_ratio"};
        case Kind::volume_ratio:
            break;
    }
    return {"volume_ratio"};
}

ActuatorKind kind_of(const sim::Description& robot, std::size_t actuator) {
    const std::size_t cables = robot.cables.size();
    return actuator < cables ? kind_of(robot.cables[actuator].target)
                             : kind_of(robot.chambers[actuator - cables].target);
}

}  // namespace pliant::view
