#include "library/simulation/measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/core/text.hpp"
#include "library/base/calls.hpp"

namespace pliant::library {
namespace {

using Kind = sim::Measure::Kind;

template <class List>
std::vector<std::string> names_in(const List& list) {
    std::vector<std::string> names;
    for (const auto& one : list) names.push_back(one.name);
    return names;
}

std::vector<std::string> obstacles_of(const sim::Description& d) {
    std::vector<std::string> names;
    if (!d.contact) return names;
    for (const sim::Obstacle& obstacle : d.contact->obstacles) names.push_back(obstacle.body.name);
    return names;
}

/// Things that a measure may be of.
struct Choice {
    Kind kind;
    const char* what;
    std::vector<std::string> names;
};

Choice choice_of(const sim::Description& d, Measure::Of of) {
    switch (of) {
        case Measure::Of::marker:
            return {Kind::marker, "marker", names_in(d.markers)};
        case Measure::Of::tension:
            return {Kind::tension, "cable", names_in(d.cables)};
        case Measure::Of::length:
            return {Kind::length, "cable", names_in(d.cables)};
        case Measure::Of::length_ratio:
            return {Kind::length_ratio, "cable", names_in(d.cables)};
        case Measure::Of::pressure:
            return {Kind::pressure, "chamber", names_in(d.chambers)};
        case Measure::Of::volume:
            return {Kind::volume, "chamber", names_in(d.chambers)};
        case Measure::Of::volume_ratio:
            return {Kind::volume_ratio, "chamber", names_in(d.chambers)};
        case Measure::Of::spring_length:
            return {Kind::spring_length, "spring", names_in(d.springs)};
        case Measure::Of::spring_force:
            return {Kind::spring_force, "spring", names_in(d.springs)};
        case Measure::Of::reaction:
            return {Kind::reaction, "support", names_in(d.supports)};
        case Measure::Of::contact_force:
            return {Kind::contact_force, "obstacle", obstacles_of(d)};
        case Measure::Of::self_contact:
            break;
    }
    return {Kind::self_contact, "self-contact", {}};
}

[[noreturn]] void refuse(const Choice& choice, const std::string& name) {
    if (choice.names.empty())
        throw Failure(Failure::Kind::input,
                      fmt::format("there is no {} \"{}\": the robot has none", choice.what, name));
    const std::string nearest = nearest_name(name, choice.names);
    throw Failure(Failure::Kind::input,
                  nearest.empty()
                      ? fmt::format("there is no {} \"{}\"; there are {}", choice.what, name, join_names(choice.names))
                      : fmt::format("there is no {} \"{}\"; did you mean \"{}\"?", choice.what, name, nearest));
}

}  // namespace

sim::Measure measure_for(const sim::Model& model, const Measure& asked) {
    const sim::Description& d = model.description();
    const Choice choice = choice_of(d, asked.of);
    const Vec3 direction{asked.direction[0], asked.direction[1], asked.direction[2]};
    if (!is_finite(direction)) throw Failure(Failure::Kind::input, "the direction of a measure is not finite");
    sim::Measure measure{choice.kind, 0, direction, {}, false};
    if (choice.kind == Kind::self_contact) return measure;
    const auto index_in = [&](const std::vector<std::string>& names) {
        return static_cast<std::size_t>(std::ranges::find(names, asked.name) - names.begin());
    };
    measure.index = index_in(choice.names);
    if (measure.index < choice.names.size()) return measure;
    const std::vector<std::string> loads = names_in(d.pressures);
    measure.index = index_in(loads);
    if (asked.of != Measure::Of::pressure || measure.index == loads.size()) refuse(choice, asked.name);
    measure.pressure_load = true;
    return measure;
}

}  // namespace pliant::library
