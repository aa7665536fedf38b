#include "robot/description/drive.hpp"

namespace pliant::robot {

double CableTarget::at(double time) const {
    return keys ? keys->at(time) : ramp(kind == Kind::length_ratio ? 1 : 0, value).at(time);
}

double ChamberTarget::at(double time) const {
    const bool ratio = kind == Kind::volume_ratio || kind == Kind::gas_ratio;
    return keys ? keys->at(time) : ramp(ratio ? 1 : 0, value).at(time);
}

}  // namespace pliant::robot
