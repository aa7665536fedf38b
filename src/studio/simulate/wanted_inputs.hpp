// What the page wants the robot to do.
#pragma once

#include <optional>
#include <vector>

#include "studio/requests/message.hpp"

namespace pliant::studio {

/// In page units, since they are taken before the robot is built. A later input takes the place of what it contradicts:
/// a slider that is moved ends playing and dragging.
struct WantedInputs {
    double tag = 0;
    double time = 0;
    double followed = 0;  ///< program time of the last "follow", for actuators that are not listed
    std::vector<ActuatorValue> actuators;
    std::vector<ActuatorValue> asked;  ///< requests since they were last processed; may be impossible
    std::optional<PullMessage> pull;
    std::optional<LeadMessage> lead;
    bool playing = false;
    bool changed = false;  ///< differs from the last one
    bool to_rest = false;
    bool show_again = false;
    bool follow = false;
    bool let_go = false;  ///< a dragged marker was released: everything stays where it is
    bool again = false;   ///< apply everything again, to a newly built robot

    void drive(const DriveMessage& message);
    void follow_program(const Follow& message);
    void play(bool on);
    void go_to_rest();
    void pull_at(const PullMessage& message);
    void lead_marker(const LeadMessage& message);
    /// Of a pulled point or dragged marker.
    void release();
    /// Takes what is asked of actuators, as far as it is possible for the robot.
    template <class CanBe>
    void take_asked(CanBe&& can_be) {
        for (const ActuatorValue& value : asked)
            if (can_be(value)) put(actuators, value);
        asked.clear();
    }
    /// Of what is to be done once.
    void forget_requests() { to_rest = show_again = follow = again = let_go = changed = false; }

private:
    /// Only the last value of an actuator counts.
    static void put(std::vector<ActuatorValue>& values, const ActuatorValue& value);
};

}  // namespace pliant::studio
