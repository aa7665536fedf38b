#include "presentation/report/frames.hpp"

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

mesh::VtuArray displacement_mm(const Simulation& s, const sim::Step& step) {
    std::vector<float> values;
    values.reserve(3 * step.positions.size());
    for (std::size_t i = 0; i < step.positions.size(); ++i) {
        const Vec3 u = 1e3 * (step.positions[i] - s.mesh.points[i]);
        for (std::size_t k = 0; k < 3; ++k) values.push_back(static_cast<float>(u[k]));
    }
    return {"displacement_mm", 3, std::move(values)};
}

mesh::VtuData frame_data(const Simulation& s, const sim::Step& step) {
    std::vector<std::int32_t> region(s.mesh.region.begin(), s.mesh.region.end());
    std::vector<std::int32_t> material;
    material.reserve(region.size());
    for (const int r : s.mesh.region) material.push_back(s.region_material[static_cast<std::size_t>(r)]);
    const sim::Fields fields = s.fields(step.positions);
    mesh::VtuData data;
    data.points.push_back(displacement_mm(s, step));
    if (s.contact_pressure_Pa)
        data.points.push_back({"contact_pressure_kPa", 1, as_floats(s.contact_pressure_Pa(step), 1e-3)});
    data.cells.push_back({"region", 1, std::move(region)});
    data.cells.push_back({"material", 1, std::move(material)});
    data.cells.push_back({"J", 1, as_floats(fields.J, 1)});
    data.cells.push_back({"von_mises_kPa", 1, as_floats(fields.von_mises_Pa, 1e-3)});
    data.cells.push_back({"max_stretch", 1, as_floats(fields.max_stretch, 1)});
    data.cells.push_back({"energy_density_kPa", 1, as_floats(fields.energy_density_Pa, 1e-3)});
    return data;
}

Status write_frame(const fs::path& path, const Simulation& s, const sim::Step& step) {
    std::vector<Vec3> points_mm;
    points_mm.reserve(step.positions.size());
    for (const Vec3& p : step.positions) points_mm.push_back(1e3 * p);
    return mesh::write_vtu(path, s.mesh, points_mm, frame_data(s, step));
}

}  // namespace

Status write_frames(const fs::path& folder, const Simulation& s, Progress& progress) {
    std::error_code code;
    fs::create_directories(folder / "frames", code);
    if (code) return failure("{}: cannot be made: {}", (folder / "frames").string(), code.message());
    std::string collection =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
        "byte_order=\"LittleEndian\">\n<Collection>\n";
    for (std::size_t i = 0; i < s.result.steps.size(); ++i) {
        if (progress.cancelled()) return cancelled();
        progress.advance("frames", static_cast<double>(i) / static_cast<double>(s.result.steps.size()));
        const std::string name = fmt::format("frames/frame_{:04}.vtu", i);
        if (Status status = write_frame(folder / name, s, s.result.steps[i]); !status) return status;
        collection +=
            fmt::format("<DataSet timestep=\"{:.10g}\" part=\"0\" file=\"{}\"/>\n", s.result.steps[i].time, name);
    }
    return write_file(folder / "frames.pvd", collection + "</Collection>\n</VTKFile>\n");
}

}  // namespace pliant::report
