#include "values.hpp"

#include <array>
#include <string_view>

#include "arrays.hpp"

namespace pliant::python {
namespace {

constexpr std::array<std::string_view, 5> kinds = {"length", "tension", "volume", "pressure", "gas"};

Drive drive_of(const std::string& kind, double value) {
    for (std::size_t k = 0; k < kinds.size(); ++k)
        if (kinds[k] == kind) return {static_cast<Drive::By>(k), value};
    throw Failure(Failure::Kind::input,
                  "\"" + kind + "\" drives nothing; write length, tension, volume, pressure or gas");
}

template <class T>
py::dict named(const std::vector<T>& all, py::object (*one)(const T&)) {
    py::dict dict;
    for (const T& thing : all) dict[py::str(thing.name)] = one(thing);
    return dict;
}

}  // namespace

InputTuple tuple_of(const Inputs& inputs) {
    InputTuple tuple{inputs.time, {}, {}};
    for (const auto* drives : {&inputs.cables, &inputs.chambers}) {
        for (const Drive& drive : *drives) {
            std::get<1>(tuple).emplace_back(kinds[static_cast<std::size_t>(drive.by)]);
            std::get<2>(tuple).push_back(drive.value);
        }
    }
    return tuple;
}

Inputs inputs_of(const Model& model, const InputTuple& tuple) {
    const auto& [time, by, values] = tuple;
    if (by.size() != values.size()) throw Failure(Failure::Kind::input, "as many kinds of drives as values are needed");
    Inputs inputs{time, {}, {}};
    const std::size_t cables = model.cables().size();
    for (std::size_t a = 0; a < by.size(); ++a)
        (a < cables ? inputs.cables : inputs.chambers).push_back(drive_of(by[a], values[a]));
    return inputs;
}

py::dict dict_of(const StepResult& result) {
    using namespace py::literals;
    return py::dict("arrived"_a = result.arrived, "loose"_a = result.loose, "reason"_a = result.reason,
                    "iterations"_a = result.iterations, "pieces"_a = result.pieces, "residual"_a = result.residual);
}

py::dict dict_of(const Observation& seen) {
    using namespace py::literals;
    using O = Observation;
    const auto cable = [](const O::Cable& c) -> py::object {
        return py::make_tuple(c.length_m, c.length_ratio, c.tension_N);
    };
    const auto chamber = [](const O::Chamber& c) -> py::object {
        return py::make_tuple(c.volume_m3, c.volume_ratio, c.pressure_Pa);
    };
    const auto spring = [](const O::Spring& s) -> py::object { return py::make_tuple(s.length_m, s.force_N); };
    const auto marker = [](const O::Marker& m) -> py::object { return array_of(m.position_m); };
    const auto force = [](const O::Force& f) -> py::object { return array_of(f.force_N); };
    const auto sensor = [](const O::Sensor& s) -> py::object {
        py::dict readings;
        for (const O::Sensor::Reading& r : s.readings) readings[py::str(r.name)] = r.value;
        return readings;
    };
    const auto joint = [](const O::Joint& j) -> py::object {
        return py::make_tuple(array_of(j.force_N), array_of(j.torque_Nm), j.coordinate, j.effort);
    };
    const auto object = [](const O::Object& o) -> py::object {
        return py::make_tuple(array_of(o.position_m), py::array_t<double>(4, o.rotation.data()), array_of(o.force_N));
    };
    return py::dict(
        "cables"_a = named<O::Cable>(seen.cables, cable), "chambers"_a = named<O::Chamber>(seen.chambers, chamber),
        "springs"_a = named<O::Spring>(seen.springs, spring), "markers"_a = named<O::Marker>(seen.markers, marker),
        "supports"_a = named<O::Force>(seen.supports, force), "contacts"_a = named<O::Force>(seen.contacts, force),
        "sensors"_a = named<O::Sensor>(seen.sensors, sensor), "joints"_a = named<O::Joint>(seen.joints, joint),
        "objects"_a = named<O::Object>(seen.objects, object), "self_contact_N"_a = seen.self_contact_N,
        "smallest_distance_m"_a = seen.smallest_distance_m, "energy_J"_a = seen.energy_J,
        "kinetic_energy_J"_a = seen.kinetic_energy_J, "min_J"_a = seen.min_J);
}

py::list parameter_list(const std::vector<Parameter>& all) {
    py::list list;
    for (const Parameter& one : all) list.append(py::make_tuple(one.name, one.unit, one.value));
    return list;
}

}  // namespace pliant::python
