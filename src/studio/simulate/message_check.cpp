#include "studio/simulate/message_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "studio/simulate/actuator_drive.hpp"

namespace pliant::studio {
namespace {

Status check_time(const Built& built, double time) {
    const double end = built.robot.program.duration;
    constexpr double slack = 1e-9;
    if (time >= 0 && time <= end * (1 + slack)) return {};
    return input_error("message: time is {:g}; the program goes from 0 to {:g}", time, end);
}

Status check_drive(const Built& built, const std::vector<double>& rest_measures, const DriveMessage& message) {
    if (message.time)
        if (Status time = check_time(built, *message.time); !time) return time;
    std::set<std::size_t> driven;
    for (const ActuatorValue& value : message.actuators) {
        const Result<ActuatorDrive> drive = drive_of(built.model, rest_measures, value);
        if (!drive) return input_error("message: actuators: {}", drive.error().message);
        if (!driven.insert(drive->actuator).second)
            return input_error("message: actuators: \"{}\" is named twice", value.name);
    }
    return {};
}

Status check_pull(const Built& built, const PullMessage& message) {
    const std::size_t count = built.scene.vertex_count();
    if (static_cast<std::size_t>(message.vertex) < count) return {};
    return input_error("message: vertex is {}; the robot has {}, from 0", message.vertex, count);
}

Status check_lead(const Built& built, const LeadMessage& message) {
    const sim::Description& d = built.model.description();
    std::vector<std::string> names;
    for (const sim::Marker& marker : d.markers) names.push_back(marker.name);
    if (std::ranges::find(names, message.marker) == names.end())
        return input_error("message: marker: {}", no_such_part("marker", message.marker, std::move(names)));
    if (d.cables.empty() && d.chambers.empty())
        return input_error("message: marker: the robot has no actuator that could bring it anywhere");
    return {};
}

}  // namespace

Status check_message(const Built& built, const std::vector<double>& rest_measures, const Message& message) {
    if (const auto* drive = std::get_if<DriveMessage>(&message)) return check_drive(built, rest_measures, *drive);
    if (const auto* follow = std::get_if<Follow>(&message)) return check_time(built, follow->time);
    if (const auto* pull = std::get_if<PullMessage>(&message)) return check_pull(built, *pull);
    if (const auto* lead = std::get_if<LeadMessage>(&message)) return check_lead(built, *lead);
    return {};
}

}  // namespace pliant::studio
