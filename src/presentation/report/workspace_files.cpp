#include "presentation/report/workspace_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "base/core/counted.hpp"
#include "base/core/csv.hpp"
#include "base/core/json.hpp"
#include "base/core/vec3.hpp"
#include "presentation/report/inverse_tables.hpp"
#include "presentation/report/tables.hpp"
#include "presentation/report/units.hpp"
#include "simulation/run/result_columns.hpp"

namespace pliant::report {
namespace {

using Json = nlohmann::ordered_json;
using sim::inverse::Workspace;
using sim::inverse::WorkspacePiece;
using sim::inverse::WorkspaceSample;

std::vector<std::string> header(const WorkspaceReport& r) {
    std::vector<std::string> cells(sim::columns::workspace.begin(), sim::columns::workspace.end());
    for (const sim::Steered& input : r.task.inputs) {
        const std::string unit = unit_of(r.model, input).name;
        cells.push_back(csv_field(unit.empty() ? input.name : input.name + "_" + unit));
    }
    const sim::Description& d = r.model.description();
    for (const sim::Marker& marker : d.markers) {
        for (const char axis : {'x', 'y', 'z'}) cells.push_back(csv_field(fmt::format("{}_{}_mm", marker.name, axis)));
    }
    for (const sim::Cable& cable : d.cables) cells.push_back(csv_field(cable.name + "_tension_N"));
    for (const sim::Chamber& chamber : d.chambers) cells.push_back(csv_field(chamber.name + "_pressure_kPa"));
    return cells;
}

/// Columns of a sample after its inputs; empty cells if there is no equilibrium.
std::string row(const WorkspaceReport& r, std::size_t piece, const WorkspaceSample& sample, std::size_t columns) {
    std::vector<std::string> cells = {fmt::format("{}", piece + 1), sample.found ? "1" : "0"};
    const auto number = [&](double value) { cells.push_back(fmt::format("{:.10g}", value)); };
    for (std::size_t i = 0; i < sample.values.size(); ++i)
        number(unit_of(r.model, r.task.inputs[i]).factor * sample.values[i]);
    for (const Vec3& p : sample.markers) {
        for (std::size_t c = 0; c < 3; ++c) number(mm_per_m * p[c]);
    }
    for (const double tension : sample.tensions_N) number(tension);
    for (const double pressure : sample.pressures_Pa) number(1e-3 * pressure);
    cells.resize(columns);
    return fmt::format("{}\n", fmt::join(cells, ","));
}

/// Every found sample of the sheets as a point, and the cells between them.
struct Sheets {
    std::vector<const WorkspaceSample*> points;
    std::vector<std::array<int, 3>> triangles;
    std::vector<std::array<int, 2>> lines;
};

void add_cells(const WorkspacePiece& piece, const std::vector<int>& index, Sheets& sheets) {
    const auto at = [&](int row, int column) { return index[static_cast<std::size_t>(row * piece.columns + column)]; };
    for (int column = 0; piece.rows == 1 && column + 1 < piece.columns; ++column) {
        if (at(0, column) >= 0 && at(0, column + 1) >= 0) sheets.lines.push_back({at(0, column), at(0, column + 1)});
    }
    for (int row = 0; row + 1 < piece.rows; ++row) {
        for (int column = 0; column + 1 < piece.columns; ++column) {
            const std::array<int, 4> corners = {at(row, column), at(row, column + 1), at(row + 1, column + 1),
                                                at(row + 1, column)};
            const auto triangle = [&](std::size_t a, std::size_t b, std::size_t c) {
                if (corners[a] >= 0 && corners[b] >= 0 && corners[c] >= 0)
                    sheets.triangles.push_back({corners[a], corners[b], corners[c]});
            };
            triangle(0, 1, 2);
            triangle(0, 2, 3);
        }
    }
}

Sheets sheets_of(const Workspace& workspace) {
    Sheets sheets;
    for (const WorkspacePiece& piece : workspace.pieces) {
        if (piece.rows == 0) continue;
        std::vector<int> index;
        for (const WorkspaceSample& sample : piece.samples) {
            index.push_back(sample.found ? static_cast<int>(sheets.points.size()) : -1);
            if (sample.found) sheets.points.push_back(&sample);
        }
        add_cells(piece, index, sheets);
    }
    return sheets;
}

/// Fields of the points of the sheets. VTK allows no blanks in their names: these become underscores, and get a number
/// where another field has that name.
class SheetFields {
public:
    explicit SheetFields(const Sheets& sheets) : sheets_(sheets) {}

    void add(std::string name, const std::function<double(const WorkspaceSample&)>& value) {
        std::ranges::replace_if(
            name, [](char c) { return c == ' ' || c == '\t' || c == '\n'; }, '_');
        const std::string plain = name;
        for (int number = 2; !taken_.insert(name).second; ++number) name = fmt::format("{}_{}", plain, number);
        text_ += fmt::format("SCALARS {} double 1\nLOOKUP_TABLE default\n", name);
        for (const WorkspaceSample* sample : sheets_.points) text_ += fmt::format("{:.10g}\n", value(*sample));
    }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    const Sheets& sheets_;
    std::set<std::string> taken_;
    std::string text_;
};

}  // namespace

std::string workspace_csv(const WorkspaceReport& r) {
    const std::vector<std::string> columns = header(r);
    std::string text = fmt::format("{}\n", fmt::join(columns, ","));
    for (std::size_t p = 0; p < r.workspace.pieces.size(); ++p) {
        for (const WorkspaceSample& sample : r.workspace.pieces[p].samples) text += row(r, p, sample, columns.size());
    }
    return text;
}

std::vector<std::string> workspace_warnings(const WorkspaceReport& r) {
    constexpr double rounding = 1e-6;
    const sim::Description& d = r.model.description();
    const double least_Pa = -d.ambient_pressure_Pa;
    std::vector<std::string> warnings;
    for (std::size_t c = 0; c < d.chambers.size(); ++c) {
        std::size_t below = 0;
        double worst_Pa = 0;
        for (const WorkspacePiece& piece : r.workspace.pieces) {
            for (const WorkspaceSample& sample : piece.samples) {
                if (!sample.found || !(sample.pressures_Pa[c] < (1 + rounding) * least_Pa)) continue;
                ++below;
                worst_Pa = std::min(worst_Pa, sample.pressures_Pa[c]);
            }
        }
        if (below == 0) continue;
        warnings.push_back(fmt::format(
            "at {} the pressure in chamber \"{}\" is below a vacuum, down to {:.4g} kPa: air cannot pull by more than "
            "{:.4g} kPa (program.ambient_pressure), so that no pump reaches such a volume",
            counted(below, "sample"), d.chambers[c].name, 1e-3 * worst_Pa, -1e-3 * least_Pa));
    }
    return warnings;
}

std::string workspace_json(const WorkspaceReport& r, int indent) {
    std::size_t samples = 0, found = 0;
    const auto& markers = r.model.description().markers;
    std::vector<Box3> boxes(markers.size());
    for (const WorkspacePiece& piece : r.workspace.pieces) {
        for (const WorkspaceSample& sample : piece.samples) {
            ++samples;
            found += sample.found ? 1 : 0;
            for (std::size_t m = 0; m < sample.markers.size(); ++m) boxes[m].add(sample.markers[m]);
        }
    }
    Json out = {{"pliant", PLIANT_VERSION},           {"robot", r.robot},   {"nodes", r.model.node_count()},
                {"tets", r.model.mesh().tet_count()}, {"samples", samples}, {"found", found}};
    out["markers"] = Json::object();
    for (std::size_t m = 0; found > 0 && m < markers.size(); ++m) {
        const Vec3 low = mm_per_m * boxes[m].low, high = mm_per_m * boxes[m].high;
        out["markers"][markers[m].name] = {{"low_mm", {low.x, low.y, low.z}}, {"high_mm", {high.x, high.y, high.z}}};
    }
    if (const std::string why = sim::inverse::why_nothing_is_found(r.workspace); !why.empty()) out["message"] = why;
    if (const std::vector<std::string> warnings = workspace_warnings(r); !warnings.empty()) out["warnings"] = warnings;
    return json_text(out, indent) + "\n";
}

mesh::TriMesh workspace_surface(const Workspace& workspace, std::size_t marker) {
    const Sheets sheets = sheets_of(workspace);
    mesh::TriMesh surface;
    for (const WorkspaceSample* sample : sheets.points) surface.points.push_back(sample->markers[marker]);
    surface.triangles = sheets.triangles;
    return surface;
}

std::string workspace_vtk(const WorkspaceReport& r, std::size_t marker) {
    const Sheets sheets = sheets_of(r.workspace);
    std::string text = fmt::format("# vtk DataFile Version 3.0\nworkspace\nASCII\nDATASET POLYDATA\nPOINTS {} double\n",
                                   sheets.points.size());
    for (const WorkspaceSample* sample : sheets.points) {
        const Vec3 p = mm_per_m * sample->markers[marker];
        text += fmt::format("{:.10g} {:.10g} {:.10g}\n", p.x, p.y, p.z);
    }
    if (!sheets.lines.empty()) text += fmt::format("LINES {} {}\n", sheets.lines.size(), 3 * sheets.lines.size());
    for (const auto& line : sheets.lines) text += fmt::format("2 {}\n", fmt::join(line, " "));
    if (!sheets.triangles.empty())
        text += fmt::format("POLYGONS {} {}\n", sheets.triangles.size(), 4 * sheets.triangles.size());
    for (const auto& triangle : sheets.triangles) text += fmt::format("3 {}\n", fmt::join(triangle, " "));
    text += fmt::format("POINT_DATA {}\n", sheets.points.size());
    SheetFields fields(sheets);
    for (std::size_t i = 0; i < r.task.inputs.size(); ++i) {
        const double factor = unit_of(r.model, r.task.inputs[i]).factor;
        fields.add(r.task.inputs[i].name, [&](const auto& sample) { return factor * sample.values[i]; });
    }
    const sim::Description& d = r.model.description();
    for (std::size_t c = 0; c < d.cables.size(); ++c)
        fields.add(d.cables[c].name + "_tension_N", [&](const auto& sample) { return sample.tensions_N[c]; });
    for (std::size_t c = 0; c < d.chambers.size(); ++c)
        fields.add(d.chambers[c].name + "_pressure_kPa",
                   [&](const auto& sample) { return 1e-3 * sample.pressures_Pa[c]; });
    return text + fields.text();
}

}  // namespace pliant::report
