// Attaches what the robot file names by position (boxes, points, paths) to nodes of the mesh.
#include "simulation/scene/build_model.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "simulation/elements/actuated_space.hpp"
#include "simulation/run/free_motion.hpp"
#include "simulation/scene/build_cables.hpp"
#include "simulation/scene/build_chambers.hpp"
#include "simulation/scene/build_contact.hpp"
#include "simulation/scene/build_description.hpp"
#include "simulation/scene/build_goals.hpp"
#include "simulation/scene/build_grades.hpp"
#include "simulation/scene/build_joints.hpp"
#include "simulation/scene/build_places.hpp"
#include "simulation/scene/build_sensors.hpp"
#include "simulation/scene/column_clashes.hpp"
#include "simulation/scene/outer_faces.hpp"

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

/// The outer surface of the bodies as triangles: what the fluid reaches.
std::vector<std::array<int, 3>> skin_of(const ModelDraft& draft) {
    std::vector<std::array<int, 3>> skin;
    for (const mesh::Face& face : body_faces(draft).outer) {
        const auto& n = face.nodes;
        if (draft.bodies.order == 1)
            skin.push_back({n[0], n[1], n[2]});
        else
            skin.insert(skin.end(), {{n[0], n[3], n[5]}, {n[3], n[1], n[4]}, {n[5], n[4], n[2]}, {n[3], n[4], n[5]}});
    }
    return skin;
}

std::optional<sim::Fluid> fluid_of(const ModelDraft& draft) {
    const auto& spec = draft.robot.fluid;
    if (!spec) return std::nullopt;
    sim::Fluid fluid{spec->density_kg_m3, spec->drag_normal, spec->drag_tangential, {},
                     spec->current_m_s,   skin_of(draft)};
    if (spec->level) fluid.level_m = draft.robot.unit_m * *spec->level;
    return fluid;
}

/// In a quasi-static program supports must hold the robot. If contact may hold what they leave free, this is only a
/// note; a robot that moves in time may be free.
Status check_free_motion(const Robot& robot, sim::Description& description) {
    if (robot.program.dynamics || !robot.joints.empty())
        return {};  // parts connected by joints get a tether, if
                    // necessary
    const auto motion = sim::free_motion(description);
    if (!motion) return {};
    if (!robot.contact && !robot.fluid)
        return input_error("{}: {}; cables, chambers, loads and gravity do not count as supports", robot.file.string(),
                           *motion);
    description.notes.push_back(*motion + "; at rest only contact can hold it");
    return {};
}

/// A support's box that was drawn too thick holds all of a thin body. Where there are objects the bodies may be no more
/// than their base.
void note_what_is_held(sim::Description& description) {
    if (!description.objects.empty()) return;
    const std::vector<int>& nodes = description.mesh.nodes;
    std::vector<char> held(description.mesh.points.size(), 0);
    for (const sim::Support& support : description.supports) {
        if (!support.directions.empty()) continue;
        for (const int node : support.nodes) held[static_cast<std::size_t>(node)] = 1;
    }
    const auto is_held = [&](int node) { return held[static_cast<std::size_t>(node)] != 0; };
    if (!nodes.empty() && std::ranges::all_of(nodes, is_held))
        description.notes.emplace_back("the supports hold every node of the bodies: nothing in them can bend or move");
}

/// The model knows lines at most.
Error in_file(const std::string& file, const Error& error) {
    std::vector<Diagnostic> problems = error.problems;
    if (problems.empty()) return {error.cause, file + ": " + error.message};
    for (Diagnostic& problem : problems) problem.file = file;
    return error_of(error.cause, std::move(problems));
}

}  // namespace

Result<sim::Description> build_description(const Robot& robot, mesh::TetMesh mesh, sim::KeptPatches* kept) {
    ModelDraft draft(robot, std::move(mesh));
    draft.kept = kept;
    const sim::Attacher attacher(draft.bodies, kept);
    sim::Description& description = draft.description;
    description.gravity_m_s2 = robot.gravity_m_s2;
    description.gravity_share = robot.gravity_share;
    description.ambient_pressure_Pa = robot.ambient_pressure_Pa;
    add_materials(draft);
    add_grades(draft);
    add_supports(draft);
    add_plates(draft);
    add_loads(draft, attacher);
    // Objects have nodes of their own, which cables, springs, markers and joints may be attached to, but which no
    // selector contains.
    Result<std::optional<sim::ContactRules>> contact = build_contact(robot, draft.bodies);
    Status objects = contact ? Status{} : Status(tl::unexpected(contact.error()));
    if (objects) {
        description.contact = std::move(*contact);
        objects = add_objects(robot, description);
    }
    if (objects) {
        add_loads_on_objects(draft);
        add_joints(draft);
    }
    add_cables(draft, attacher);
    add_springs(draft, attacher);
    add_chambers(draft, attacher);
    add_markers(draft, attacher);
    add_masses(draft, attacher);
    if (!draft.problems.empty()) return tl::unexpected(error_of(Cause::input, draft.problems));
    if (!objects) return tl::unexpected(objects.error());
    description.may_be_free = may_be_free(robot);
    description.moves_in_time = robot.program.dynamics.has_value();
    description.fluid = fluid_of(draft);
    add_sensors(draft, attacher);
    if (draft.problems.empty()) check_columns(draft);
    if (!draft.problems.empty()) return tl::unexpected(error_of(Cause::input, draft.problems));
    description.notes = draft.notes_on_points();
    if (description.contact) {
        for (std::string& note : notes_on_contact(robot, draft.bodies, *description.contact))
            description.notes.push_back(std::move(note));
    }
    for (std::string& note : notes_on_goals(robot, description.mesh)) description.notes.push_back(std::move(note));
    note_what_is_held(description);
    if (Status held = check_free_motion(robot, description); !held) return tl::unexpected(held.error());
    return std::move(description);
}

Result<sim::Model> build_model(const Robot& robot, mesh::TetMesh mesh, sim::KeptPatches* kept) {
    Result<sim::Description> description = build_description(robot, std::move(mesh), kept);
    if (!description) return tl::unexpected(description.error());
    Result<sim::Model> model = sim::Model::create(std::move(*description));
    if (!model) return tl::unexpected(in_file(robot.file.string(), model.error()));
    return model;
}

}  // namespace pliant::robot
