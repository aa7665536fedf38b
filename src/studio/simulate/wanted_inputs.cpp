#include "studio/simulate/wanted_inputs.hpp"

#include <algorithm>

namespace pliant::studio {

void WantedInputs::put(std::vector<ActuatorValue>& values, const ActuatorValue& value) {
    std::erase_if(values, [&](const ActuatorValue& v) { return v.name == value.name; });
    values.push_back(value);
}

void WantedInputs::drive(const DriveMessage& message) {
    tag = message.tag;
    if (message.time) time = *message.time;
    if (message.time) follow = false;
    for (const ActuatorValue& value : message.actuators) put(asked, value);
    playing = false;
    lead.reset();
    let_go = false;
    changed = true;
}

void WantedInputs::follow_program(const Follow& message) {
    tag = message.tag;
    time = followed = std::max(message.time, 0.0);
    actuators.clear();
    asked.clear();
    follow = true;
    playing = false;
    lead.reset();
    changed = true;
}

void WantedInputs::play(bool on) {
    playing = on;
    changed = true;
    if (!on) return;
    actuators.clear();
    asked.clear();
    lead.reset();
}

void WantedInputs::go_to_rest() {
    *this = {};
    to_rest = changed = true;
}

void WantedInputs::pull_at(const PullMessage& message) {
    pull = message;
    tag = message.tag;
    changed = true;
}

void WantedInputs::lead_marker(const LeadMessage& message) {
    lead = message;
    pull.reset();
    playing = false;
    tag = message.tag;
    changed = true;
}

void WantedInputs::release() {
    pull.reset();
    let_go = lead.has_value();
    lead.reset();
    changed = true;
}

}  // namespace pliant::studio
