#include "simulation/scene/column_clashes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "simulation/run/result_columns.hpp"
#include "simulation/run/sensors.hpp"

namespace pliant::robot {
namespace {

class Columns {
public:
    explicit Columns(ModelDraft& draft) : draft_(draft) {}

    /// The columns NAME_ENDING of a thing, for each of these endings. False if another thing has one of them.
    template <class Spec>
    bool take(std::string_view kind, const Spec& spec, std::span<const std::string_view> endings) {
        return std::ranges::all_of(endings, [&](std::string_view ending) {
            return take_one(kind, spec.name, spec.line, fmt::format("{}_{}", spec.name, ending));
        });
    }
    /// The name by which an actuator is driven. False if another actuator has it.
    template <class Spec>
    bool take_name(std::string_view kind, const Spec& spec) {
        const auto [other, is_new] = driven_.emplace(spec.name, fmt::format("{} \"{}\"", kind, spec.name));
        if (!is_new)
            draft_.problem(
                spec.line, kind, spec.name,
                fmt::format("is driven by the same name as {}; give one of the two another name", other->second));
        return is_new;
    }
    /// The input of an actuator that the inverse moves.
    template <class Spec>
    void take_input(std::string_view kind, const Spec& spec) {
        if (spec.steering) take_one(kind, spec.name, spec.line, spec.name);
    }

private:
    /// False, with a problem, if another thing has this column.
    bool take_one(std::string_view kind, const std::string& name, int line, const std::string& column) {
        const std::string thing = fmt::format("{} \"{}\"", kind, name);
        const auto [other, is_new] = owner_.emplace(column, thing);
        if (!is_new)
            draft_.problem(line, kind, name,
                           fmt::format("has the column \"{}\" in the tables of results, and so has {}; give one of the "
                                       "two another name",
                                       column, other->second));
        return is_new;
    }

    ModelDraft& draft_;
    std::map<std::string, std::string> owner_;
    std::map<std::string, std::string> driven_;
};

void take_actuators(const Robot& robot, Columns& columns) {
    for (const CableSpec& c : robot.cables) {
        if (columns.take_name("cable", c) && columns.take("cable", c, sim::columns::cable))
            columns.take_input("cable", c);
    }
    for (const ChamberSpec& c : robot.chambers) {
        if (columns.take_name("chamber", c) && columns.take("chamber", c, sim::columns::chamber))
            columns.take_input("chamber", c);
    }
    for (const SpringSpec& s : robot.springs) columns.take("spring", s, sim::columns::spring);
}

void take_joint(const JointSpec& joint, Columns& columns) {
    if (!columns.take("joint", joint, sim::columns::joint)) return;
    if (joint.kind == JointSpec::Kind::hinge || joint.kind == JointSpec::Kind::motor)
        columns.take("joint", joint, sim::columns::turning);
    if (joint.kind == JointSpec::Kind::slider) columns.take("joint", joint, sim::columns::sliding);
}

void take_bodies(const Robot& robot, Columns& columns) {
    for (const FixedSpec& f : robot.fixed) columns.take("fixed", f, sim::columns::force);
    for (const ObstacleSpec& o : robot.obstacles) columns.take("obstacle", o, sim::columns::force);
    for (const ObjectSpec& o : robot.objects) columns.take("object", o, sim::columns::object);
    for (const JointSpec& j : robot.joints) take_joint(j, columns);
}

void take_sensor(const SensorSpec& spec, const sim::Sensor& sensor, Columns& columns) {
    for (const auto& [name, quantity] : sim::readings_of(sensor)) {
        const std::string ending = fmt::format("{}{}", name, sim::shown(quantity).suffix);
        if (!columns.take("sensor", spec, std::array<std::string_view, 1>{ending})) return;
    }
}

}  // namespace

void check_columns(ModelDraft& draft) {
    Columns columns(draft);
    take_actuators(draft.robot, columns);
    take_bodies(draft.robot, columns);
    const auto& sensors = draft.robot.sensors;
    for (std::size_t k = 0; k < sensors.size(); ++k) take_sensor(sensors[k], draft.description.sensors[k], columns);
}

}  // namespace pliant::robot
