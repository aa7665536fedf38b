#include "library/simulation/measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/core/text.hpp"
#include "library/base/calls.hpp"

namespace pliant::library {
namespace {

using MeasureKind = sim::Measure::Kind;

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
    MeasureKind kind;
    const char* what;
    std::vector<std::string> names;
};

Choice choice_of(const sim::Description& d, Measure::Of of) {
    switch (of) {
        case Measure::Of::marker:
            return {MeasureKind::marker, "marker", names_in(d.markers)};
        case Measure::Of::tension:
            return {MeasureKind::tension, "cable", names_in(d.cables)};
        case Measure::Of::length:
            return {MeasureKind::length, "cable", names_in(d.cables)};
        case Measure::Of::length_ratio:
            return {MeasureKind::length_ratio, "cable", names_in(d.cables)};
        case Measure::Of::pressure:
            return {MeasureKind::pressure, "chamber", names_in(d.chambers)};
        case Measure::Of::volume:
            return {MeasureKind::volume, "chamber", names_in(d.chambers)};
        case Measure::Of::volume_ratio:
            return {MeasureKind::volume_ratio, "chamber", names_in(d.chambers)};
        case Measure::Of::spring_length:
            return {MeasureKind::spring_length, "spring", names_in(d.springs)};
        case Measure::Of::spring_force:
            return {MeasureKind::spring_force, "spring", names_in(d.springs)};
        case Measure::Of::reaction:
            return {MeasureKind::reaction, "support", names_in(d.supports)};
        case Measure::Of::contact_force:
            return {MeasureKind::contact_force, "obstacle", obstacles_of(d)};
        case Measure::Of::self_contact:
            return {MeasureKind::self_contact, "self-contact", {}};
    }
    throw Failure(Failure::Kind::input,
                  fmt::format("there is no measure of kind {}; take one of Measure::Of", static_cast<int>(of)));
}

[[noreturn]] void refuse_name(const Choice& choice, const std::string& name) {
    if (choice.names.empty())
        throw Failure(Failure::Kind::input,
                      fmt::format("there is no {} \"{}\": the robot has none", choice.what, name));
    const std::string nearest = nearest_name(name, choice.names);
    throw Failure(Failure::Kind::input,
                  nearest.empty()
                      ? fmt::format("there is no {} \"{}\"; there are {}", choice.what, name, join_names(choice.names))
                      : fmt::format("there is no {} \"{}\"; did you mean \"{}\"?", choice.what, name, nearest));
}

bool has_direction(MeasureKind kind) {
    return kind == MeasureKind::marker || kind == MeasureKind::reaction || kind == MeasureKind::contact_force;
}

void expect_direction(const Choice& choice, const std::string& name, const Vec3& direction) {
    if (!is_finite(direction)) throw Failure(Failure::Kind::input, "the direction of a measure is not finite");
    if (has_direction(choice.kind) && !(norm(direction) > 0))
        throw Failure(Failure::Kind::input,
                      fmt::format("a measure of {} \"{}\" needs a direction, such as (0, 0, 1)", choice.what, name));
}

}  // namespace

sim::Measure measure_for(const sim::Model& model, const Measure& asked) {
    const sim::Description& d = model.description();
    const Choice choice = choice_of(d, asked.of);
    const Vec3 direction{asked.direction[0], asked.direction[1], asked.direction[2]};
    sim::Measure measure{choice.kind, 0, direction, {}, false};
    if (choice.kind == MeasureKind::self_contact) return measure;
    const auto index_in = [&](const std::vector<std::string>& names) {
        return static_cast<std::size_t>(std::ranges::find(names, asked.name) - names.begin());
    };
    measure.index = index_in(choice.names);
    if (measure.index < choice.names.size()) {
        expect_direction(choice, asked.name, direction);
        return measure;
    }
    const std::vector<std::string> loads = names_in(d.pressures);
    measure.index = index_in(loads);
    if (asked.of != Measure::Of::pressure || measure.index == loads.size()) refuse_name(choice, asked.name);
    measure.pressure_load = true;
    return measure;
}

}  // namespace pliant::library
