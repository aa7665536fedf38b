#include "simulation/run/step_record.hpp"

#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/stepper/cbor_numbers.hpp"

namespace pliant::sim {
namespace {

using cbor::Json;
using cbor::packed;
using cbor::Reader;

static_assert(sizeof(Vec3) == 3 * sizeof(double));

Json json_of(const Vec3& v) {
    return {v.x, v.y, v.z};
}

std::span<const double> flat(std::span<const Vec3> points) {
    return {points.empty() ? nullptr : &points.data()->x, 3 * points.size()};
}

Json json_of(const IterationRecord& r) {
    return {r.step,  r.time, static_cast<int>(r.solver), r.iteration, r.residual, r.violation, r.energy_J,
            r.alpha, r.min_J};
}

/// A list of names, each with a fixed number of values.
template <class T, class Numbers>
Json named(const std::vector<T>& all, const Numbers& numbers) {
    Json list = Json::array();
    for (const T& one : all) list.push_back({one.name, numbers(one)});
    return list;
}

class StepReader {
public:
    explicit StepReader(const Json& json) : in_(json) {}

    [[nodiscard]] const Status& status() const { return in_.status(); }

    StepRecord read(std::size_t nodes) {
        constexpr int most = 1 << 30;
        StepRecord record;
        Step& step = record.step;
        step.index = in_.integer("index", 0, most);
        step.time = in_.number("time");
        step.converged = in_.boolean("converged");
        step.reason = in_.text("reason");
        step.iterations = in_.integer("iterations", 0, most);
        step.substeps = in_.integer("substeps", 0, most);
        if (in_.has("refused")) step.refused = in_.integer("refused", 0, most);
        step.residual = in_.number("residual");
        step.solver = static_cast<Solver>(in_.integer("solver", 0, last_solver));
        step.wall_s = in_.number("wall_s");
        step.min_J = in_.number("min_J");
        step.energy_J = in_.number("energy_J");
        step.kinetic_energy_J = in_.number("kinetic_energy_J");
        each("cables", 3, [&](auto& n, auto& v) { step.cables.push_back({n, v[0], v[1], v[2]}); });
        each("chambers", 3, [&](auto& n, auto& v) { step.chambers.push_back({n, v[0], v[1], v[2]}); });
        each("springs", 2, [&](auto& n, auto& v) { step.springs.push_back({n, v[0], v[1]}); });
        each("supports", 3, [&](auto& n, auto& v) { step.supports.push_back({n, {v[0], v[1], v[2]}}); });
        each("contacts", 3, [&](auto& n, auto& v) { step.contacts.push_back({n, {v[0], v[1], v[2]}}); });
        each("markers", 3, [&](auto& n, auto& v) { step.markers.push_back({n, {v[0], v[1], v[2]}}); });
        each("objects", 10, [&](auto& n, auto& v) {
            step.objects.push_back({n, {v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}, {v[7], v[8], v[9]}});
        });
        each("joints", 10, [&](auto& n, auto& v) {
            step.joints.push_back({n, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6] != 0, v[7] != 0, v[8], v[9]});
        });
        if (in_.has("sensors")) sensors(step);
        step.self_contact_N = in_.number("self_contact_N");
        step.smallest_distance_m = in_.number("smallest_distance_m");
        step.met = in_.boolean("met");
        step.positions = positions(nodes);
        record.iterations = history();
        return record;
    }

private:
    static constexpr int last_solver = static_cast<int>(all_solvers.size()) - 1;

    template <class Take>
    void each(const char* key, std::size_t count, const Take& take) {
        const Json& list = in_.at(key);
        if (!list.is_array()) in_.fail(std::string(key) + " is not a list");
        for (const Json& one : list) {
            const bool is_named =
                one.is_array() && one.size() == 2 && one[0].is_string() && one[1].is_array() && one[1].size() == count;
            if (!is_named) return in_.fail(std::string(key) + " has an entry of another kind");
            std::vector<double> numbers;
            for (const Json& value : one[1]) {
                if (!value.is_number()) return in_.fail(std::string(key) + " has an entry that is not a number");
                numbers.push_back(value.get<double>());
            }
            take(one[0].get_ref<const std::string&>(), numbers);
        }
    }

    /// For each sensor its name and readings: name, measure, value.
    void sensors(Step& step) {
        const Json& list = in_.at("sensors");
        if (!list.is_array()) return in_.fail("sensors is not a list");
        for (const Json& one : list) {
            if (!one.is_array() || one.size() != 2 || !one[0].is_string() || !one[1].is_array())
                return in_.fail("sensors has an entry of another kind");
            SensorState sensor{one[0].get<std::string>(), {}};
            for (const Json& r : one[1]) {
                const bool is_reading = r.is_array() && r.size() == 3 && r[0].is_string() && r[1].is_number_integer() &&
                                        r[2].is_number() && r[1].get<int>() >= 0 &&
                                        r[1].get<int>() <= static_cast<int>(SensedQuantity::angular_velocity);
                if (!is_reading) return in_.fail("sensors has a reading of another kind");
                sensor.readings.push_back(
                    {r[0].get<std::string>(), static_cast<SensedQuantity>(r[1].get<int>()), r[2].get<double>()});
            }
            step.sensors.push_back(std::move(sensor));
        }
    }

    std::vector<Vec3> positions(std::size_t nodes) {
        return linalg::points_of(in_.vector("positions", static_cast<Eigen::Index>(3 * nodes)));
    }

    std::vector<IterationRecord> history() {
        std::vector<IterationRecord> records;
        const Json& list = in_.at("history");
        if (!list.is_array()) in_.fail("history is not a list");
        for (const Json& one : list) {
            if (!one.is_array() || one.size() != 9) {
                in_.fail("history has an entry of another kind");
                break;
            }
            for (const Json& value : one) {
                if (!value.is_number()) in_.fail("history has an entry that is not a number");
            }
            if (in_.status() && !(one[2] >= 0 && one[2] <= last_solver)) in_.fail("a solver that does not exist");
            if (!in_.status()) break;
            records.push_back({one[0], one[1], static_cast<Solver>(one[2].get<int>()), one[3], one[4], one[5], one[6],
                               one[7], one[8]});
        }
        return records;
    }

    Reader in_;
};

}  // namespace

std::string step_bytes(const Step& step, std::span<const IterationRecord> iterations) {
    Json json{{"index", step.index},
              {"time", step.time},
              {"converged", step.converged},
              {"reason", step.reason},
              {"iterations", step.iterations},
              {"substeps", step.substeps},
              {"residual", step.residual},
              {"solver", static_cast<int>(step.solver)},
              {"wall_s", step.wall_s},
              {"min_J", step.min_J},
              {"energy_J", step.energy_J},
              {"kinetic_energy_J", step.kinetic_energy_J},
              {"self_contact_N", step.self_contact_N},
              {"smallest_distance_m", step.smallest_distance_m},
              {"met", step.met},
              {"positions", packed(flat(step.positions))},
              {"history", Json::array()}};
    json["cables"] = named(step.cables, [](const CableState& c) -> Json {
        return {c.length_ratio, c.length_m, c.tension_N};
    });
    json["chambers"] = named(step.chambers, [](const ChamberState& c) -> Json {
        return {c.volume_ratio, c.volume_m3, c.pressure_Pa};
    });
    json["springs"] = named(step.springs, [](const SpringState& s) -> Json { return {s.length_m, s.force_N}; });
    json["supports"] = named(step.supports, [](const SupportState& s) { return json_of(s.force_N); });
    json["contacts"] = named(step.contacts, [](const ContactState& c) { return json_of(c.force_N); });
    json["markers"] = named(step.markers, [](const MarkerState& m) { return json_of(m.position_m); });
    json["objects"] = named(step.objects, [](const ObjectState& o) -> Json {
        const auto& q = o.rotation;
        return {o.position_m.x, o.position_m.y, o.position_m.z, q[0],        q[1],
                q[2],           q[3],           o.force_N.x,    o.force_N.y, o.force_N.z};
    });
    json["joints"] = named(step.joints, [](const JointState& j) -> Json {
        return {j.force_N.x,   j.force_N.y,       j.force_N.z,        j.torque_Nm.x, j.torque_Nm.y,
                j.torque_Nm.z, j.turns ? 1.0 : 0, j.slides ? 1.0 : 0, j.coordinate,  j.effort};
    });
    if (step.refused > 0) json["refused"] = step.refused;
    if (!step.sensors.empty()) {
        json["sensors"] = named(step.sensors, [](const SensorState& sensor) {
            Json readings = Json::array();
            for (const Reading& r : sensor.readings)
                readings.push_back(Json::array({r.name, static_cast<int>(r.quantity), r.value}));
            return readings;
        });
    }
    for (const IterationRecord& record : iterations) json["history"].push_back(json_of(record));
    std::string bytes;
    Json::to_cbor(json, bytes);
    return bytes;
}

Result<StepRecord> step_from_bytes(std::string_view bytes, std::size_t nodes) {
    const Json json = cbor::parsed(bytes);
    StepReader reader(json);
    StepRecord record = reader.read(nodes);
    if (!reader.status()) return tl::unexpected(reader.status().error());
    return record;
}

}  // namespace pliant::sim
