// The workspace of markers: a table, and the sheets as surfaces.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh/tri_mesh.hpp"
#include "simulation/inverse/workspace.hpp"
#include "simulation/model/model.hpp"

namespace pliant::report {

struct WorkspaceReport {
    std::string robot;
    const sim::Model& model;
    const sim::InverseTask& task;
    const sim::inverse::Workspace& workspace;
};

/// One row per sample: piece, inputs, found, markers, tensions, pressures.
[[nodiscard]] std::string workspace_csv(const WorkspaceReport& report);
/// Reasons not to trust a sample, one sentence each: chambers whose pressure falls below a vacuum, which no air can do.
[[nodiscard]] std::vector<std::string> workspace_warnings(const WorkspaceReport& report);
/// Number of samples, how many have an equilibrium, the bounding box of each marker, mm, and the warnings, if any.
[[nodiscard]] std::string workspace_json(const WorkspaceReport& report, int indent = 2);
/// The sheets reached by a marker, m: two triangles for every four neighbours with an equilibrium. Empty if there are
/// none.
[[nodiscard]] mesh::TriMesh workspace_surface(const sim::inverse::Workspace& workspace, std::size_t marker);
/// The same, and lines of a single input, as legacy VTK with inputs, tensions (N) and pressures (kPa) at every point,
/// mm.
[[nodiscard]] std::string workspace_vtk(const WorkspaceReport& report, std::size_t marker);

}  // namespace pliant::report
