#include "simulation/distributed/abilities.hpp"

#include <string>

namespace pliant::sim::distributed {
namespace {

tl::unexpected<Error> refused(const std::string& key, const std::string& what) {
    return input_error("{}: pliant-mpi does not support {}; pliant simulate does", key, what);
}

std::string named(const char* kind, const std::string& name) {
    return std::string("[[") + kind + "]] \"" + name + "\"";
}

Status check_actuators(const Description& d) {
    for (const Growth& growth : d.growths) {
        const auto a = static_cast<std::size_t>(growth.actuator);
        if (a < d.cables.size())
            return refused(named("cable", d.cables[a].name) + ": model = \"gap-elements\"", "gap elements");
        return refused(named("chamber", d.chambers[a - d.cables.size()].name) + ": model = \"elements\"",
                       "chambers made of elements");
    }
    for (const Cable& cable : d.cables) {
        if (cable.friction > 0) return refused(named("cable", cable.name) + ": friction", "friction in guides");
    }
    return {};
}

}  // namespace

Status check_able(const Description& d, const Program& program) {
    if (program.dynamics) return refused("program.time_step", "motion in time");
    if (program.solver != Solver::automatic && program.solver != Solver::newton)
        return refused("program.solver = \"" + std::string(name(program.solver)) + "\"", "solvers other than newton");
    if (program.imperfection_m > 0) return refused("program.imperfection", "leaving unstable equilibria");
    if (!d.objects.empty()) return refused(named("object", d.objects.front().name), "free bodies");
    if (d.contact && !d.contact->obstacles.empty())
        return refused(named("obstacle", d.contact->obstacles.front().body.name), "contact");
    if (d.contact && !d.contact->self_when_met) return refused("[contact]", "contact");
    if (d.fluid) return refused("[fluid]", "fluids");
    if (!d.joints.empty()) return refused(named("joint", d.joints.front().name), "joints");
    if (!d.plates.empty()) return refused(named("plate", d.plates.front().name), "rigid plates");
    if (!d.torques.empty()) return refused(named("load", d.torques.front().name) + ": torque", "torques");
    if (!d.sensors.empty()) return refused(named("sensor", d.sensors.front().name), "sensors");
    if (!d.springs.empty()) return refused(named("spring", d.springs.front().name), "springs");
    return check_actuators(d);
}

}  // namespace pliant::sim::distributed
