#include "presentation/report/frames.hpp"

#include <algorithm>
#include <system_error>

#include "base/core/files.hpp"
#include "geometry/files/vtu_writer.hpp"

namespace pliant::report {
namespace {

namespace fs = std::filesystem;

std::vector<float> as_floats(std::span<const double> values, double factor) {
    std::vector<float> out;
    out.reserve(values.size());
    for (const double v : values) out.push_back(static_cast<float>(factor * v));
    return out;
}

/// Without the points after the last one of a tet: objects move by such points, which lie in no body.
mesh::TetMesh bodies_of(const Simulation& s) {
    mesh::TetMesh bodies = s.mesh;
    bodies.points.resize(static_cast<std::size_t>(std::ranges::max(bodies.nodes)) + 1);
    return bodies;
}

mesh::VtuArray displacement_mm(const mesh::TetMesh& bodies, const sim::Step& step) {
    std::vector<float> values;
    values.reserve(3 * bodies.points.size());
    for (std::size_t i = 0; i < bodies.points.size(); ++i) {
        const Vec3 u = 1e3 * (step.positions[i] - bodies.points[i]);
        for (std::size_t k = 0; k < 3; ++k) values.push_back(static_cast<float>(u[k]));
    }
    return {"displacement_mm", 3, std::move(values)};
}

mesh::VtuData frame_data(const Simulation& s, const mesh::TetMesh& bodies, const sim::Step& step) {
    std::vector<std::int32_t> region(s.mesh.region.begin(), s.mesh.region.end());
    std::vector<std::int32_t> material;
    material.reserve(region.size());
    for (const int r : s.mesh.region) material.push_back(s.region_material[static_cast<std::size_t>(r)]);
    const sim::Fields fields = s.fields(step.positions);
    mesh::VtuData data;
    data.region_names = bodies.region_names;
    data.points.push_back(displacement_mm(bodies, step));
    if (s.contact_pressure_Pa) {
        const std::vector<double> pressure_Pa = s.contact_pressure_Pa(step);
        const std::span<const double> of_bodies = std::span(pressure_Pa).first(bodies.points.size());
        data.points.push_back({"contact_pressure_kPa", 1, as_floats(of_bodies, 1e-3)});
    }
    data.cells.push_back({"region", 1, std::move(region)});
    data.cells.push_back({"material", 1, std::move(material)});
    data.cells.push_back({"J", 1, as_floats(fields.J, 1)});
    data.cells.push_back({"von_mises_kPa", 1, as_floats(fields.von_mises_Pa, 1e-3)});
    data.cells.push_back({"max_stretch", 1, as_floats(fields.max_stretch, 1)});
    data.cells.push_back({"energy_density_kPa", 1, as_floats(fields.energy_density_Pa, 1e-3)});
    return data;
}

Status write_frame(const fs::path& path, const Simulation& s, const mesh::TetMesh& bodies, const sim::Step& step) {
    std::vector<Vec3> points_mm;
    points_mm.reserve(bodies.points.size());
    for (std::size_t i = 0; i < bodies.points.size(); ++i) points_mm.push_back(1e3 * step.positions[i]);
    return mesh::write_vtu(path, bodies, points_mm, frame_data(s, bodies, step));
}

}  // namespace

Status write_frames(const fs::path& folder, const Simulation& s, Progress& progress) {
    std::error_code code;
    fs::create_directories(folder / "frames", code);
    if (code) return failure("{}: cannot be made: {}", (folder / "frames").string(), code.message());
    const mesh::TetMesh bodies = bodies_of(s);
    std::string collection =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
        "byte_order=\"LittleEndian\">\n<Collection>\n";
    for (std::size_t i = 0; i < s.result.steps.size(); ++i) {
        if (progress.cancelled()) return cancelled();
        progress.advance("frames", static_cast<double>(i) / static_cast<double>(s.result.steps.size()));
        const std::string name = fmt::format("frames/frame_{:04}.vtu", i);
        if (Status status = write_frame(folder / name, s, bodies, s.result.steps[i]); !status) return status;
        collection +=
            fmt::format("<DataSet timestep=\"{:.10g}\" part=\"0\" file=\"{}\"/>\n", s.result.steps[i].time, name);
    }
    return write_file(folder / "frames.pvd", collection + "</Collection>\n</VTKFile>\n");
}

}  // namespace pliant::report
