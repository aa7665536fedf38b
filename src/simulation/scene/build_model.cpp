// Ties what the robot file names by place (boxes, points, paths) to nodes of the mesh.
#include "simulation/scene/build_model.hpp"

#include <utility>

#include "simulation/elements/actuated_space.hpp"
#include "simulation/run/free_motion.hpp"
#include "simulation/scene/build_cables.hpp"
#include "simulation/scene/build_chambers.hpp"
#include "simulation/scene/build_contact.hpp"
#include "simulation/scene/build_grades.hpp"
#include "simulation/scene/build_places.hpp"

namespace pliant::robot {
namespace {

void add_materials(ModelDraft& draft) {
    for (const MaterialSpec& m : draft.robot.materials)
        draft.description.materials.push_back({m.name, m.law, m.density_kg_m3});
    for (const BodySpec& body : draft.robot.bodies) draft.description.material_of_region.push_back(body.material);
    for (const Region& region : regions_of(draft.robot)) {
        if (region.use == Region::Use::body || !region.has_elements) continue;
        draft.description.material_of_region.push_back(static_cast<int>(draft.description.materials.size()));
        const double softest = softest_Pa(draft.robot);
        draft.description.materials.push_back({std::string(region.name),
                                               region.use == Region::Use::gap
                                                   ? sim::gap_law(softest)
                                                   : sim::air_law(softest, draft.robot.chambers[region.index].weight),
                                               0});
    }
    for (const int notch : draft.notches) {
        draft.description.material_of_region.push_back(static_cast<int>(draft.description.materials.size()));
        draft.description.materials.push_back({draft.description.mesh.region_names[static_cast<std::size_t>(notch)],
                                               sim::gap_law(softest_Pa(draft.robot)), 0});
    }
}

/// At rest the supports alone hold a robot. Contact may do what they leave, so that then it is only said; and a robot
/// that moves in time may be free.
Status check_free_motion(const Robot& robot, sim::Description& description) {
    if (robot.program.dynamics) return {};
    const auto motion = sim::free_motion(description);
    if (!motion) return {};
    if (!robot.contact)
        return input_error("{}: {}; cables, chambers, loads and gravity do not count as supports", robot.file.string(),
                           *motion);
    description.notes.push_back(*motion + "; at rest only contact can hold it");
    return {};
}

}  // namespace

Result<sim::Model> build_model(const Robot& robot, mesh::TetMesh mesh) {
    ModelDraft draft(robot, std::move(mesh));
    const sim::Attacher attacher(draft.bodies);
    sim::Description& description = draft.description;
    description.gravity_m_s2 = robot.gravity_m_s2;
    description.gravity_share = robot.gravity_share;
    description.ambient_pressure_Pa = robot.ambient_pressure_Pa;
    add_materials(draft);
    add_grades(draft);
    add_supports(draft);
    add_plates(draft);
    add_loads(draft);
    add_cables(draft, attacher);
    add_springs(draft, attacher);
    add_chambers(draft, attacher);
    add_markers(draft, attacher);
    add_masses(draft, attacher);
    if (!draft.problems.empty()) return tl::unexpected(error_of(Cause::input, draft.problems));
    Result<std::optional<sim::ContactRules>> contact = build_contact(robot, draft.bodies);
    if (!contact) return tl::unexpected(contact.error());
    description.contact = std::move(*contact);
    description.may_be_free = may_be_free(robot);
    if (Status status = add_objects(robot, description); !status) return tl::unexpected(status.error());
    description.notes = draft.notes_on_points();
    if (Status held = check_free_motion(robot, description); !held) return tl::unexpected(held.error());
    Result<sim::Model> model = sim::Model::create(std::move(description));
    if (!model) return tl::unexpected(Error{model.error().cause, robot.file.string() + ": " + model.error().message});
    return model;
}

}  // namespace pliant::robot
