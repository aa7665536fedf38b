#include "simulation/distributed/frames.hpp"

#include <fmt/format.h>

#include <span>
#include <utility>

#include "simulation/distributed/h5_file.hpp"
#include "simulation/run/element_fields.hpp"

namespace pliant::sim::distributed {
namespace {

constexpr double mm_per_m = 1e3;

std::string file_name(int step) {
    return fmt::format("{:04}.h5", step);
}

/// Escapes text for XML.
std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

std::string item(const std::string& place, const std::string& size, bool numbers_are_int = false) {
    return fmt::format("<DataItem Format=\"HDF\" Dimensions=\"{}\" {}>frames/{}</DataItem>", size,
                       numbers_are_int ? "NumberType=\"Int\"" : "NumberType=\"Float\" Precision=\"8\"", place);
}

std::string attribute(const char* name, const char* kind, const char* centre, const std::string& data) {
    return fmt::format("  <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n", name, kind,
                       centre, data);
}

}  // namespace

Status write_frame_mesh(const std::filesystem::path& folder, const Description& d) {
    Result<H5File> file = H5File::create(nullptr, folder / "mesh.h5");
    if (!file) return tl::unexpected(file.error());
    const auto tets = static_cast<int>(d.mesh.tet_count());
    const Rows rows{tets, 0, tets};
    std::vector<int> material = d.material_of_tet;
    if (material.empty())
        for (const int region : d.mesh.region)
            material.push_back(d.material_of_region[static_cast<std::size_t>(region)]);
    file->write("tets", rows, d.mesh.nodes_per_tet(), d.mesh.nodes);
    file->write("region", rows, 1, d.mesh.region);
    file->write("material", rows, 1, material);
    return file->close();
}

Frames::Frames(const DistributedEquilibrium& system, std::filesystem::path folder)
    : system_(system),
      folder_(std::move(folder)),
      nodes_(system.ranks(),
             std::span(system.share().node_in_file).first(static_cast<std::size_t>(system.share().owned)),
             system.share().whole.nodes),
      tets_(system.ranks(), system.share().tet_in_file, system.share().whole.tets) {}

Status Frames::write(int step, const Eigen::VectorXd& x) {
    const auto own = static_cast<std::size_t>(system_.nodes().owned());
    std::vector<double> points(own), displacement(own);
    for (std::size_t k = 0; k < own; ++k) {
        points[k] = mm_per_m * x[static_cast<Eigen::Index>(k)];
        displacement[k] = points[k] - mm_per_m * system_.part().mesh.points[k / 3][k % 3];
    }
    Fields fields = fields_of(system_.elements(), {x.data(), static_cast<std::size_t>(x.size())});
    for (double& value : fields.von_mises_Pa) value *= 1e-3;
    for (double& value : fields.energy_density_Pa) value *= 1e-3;
    Result<H5File> file = H5File::create(&system_.ranks(), folder_ / file_name(step));
    if (!file) return tl::unexpected(file.error());
    const auto put = [&](const char* name, const FileOrder& order, int width, std::span<const double> values) {
        const std::vector<double> sorted = order.sorted(values, width);
        file->write(name, {order.total(), order.first(), order.rows()}, width, sorted);
    };
    put("points_mm", nodes_, 3, points);
    put("displacement_mm", nodes_, 3, displacement);
    put("J", tets_, 1, fields.J);
    put("von_mises_kPa", tets_, 1, fields.von_mises_Pa);
    put("max_stretch", tets_, 1, fields.max_stretch);
    put("energy_density_kPa", tets_, 1, fields.energy_density_Pa);
    return file->close();
}

std::string frames_xdmf(const std::string& robot, int nodes, int tets, int order, const std::vector<FrameTime>& steps) {
    const std::string vectors = fmt::format("{} 3", nodes), scalars = fmt::format("{}", tets);
    const std::string topology =
        fmt::format("  <Topology TopologyType=\"{}\" NumberOfElements=\"{}\">{}</Topology>\n",
                    order == 2 ? "Tetrahedron_10" : "Tetrahedron", tets,
                    item("mesh.h5:/tets", fmt::format("{} {}", tets, order == 2 ? 10 : 4), true));
    std::string out = fmt::format(
        "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\"><Domain>\n"
        "<Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
        escaped(robot));
    for (const FrameTime& at : steps) {
        const std::string file = file_name(at.step) + ":/";
        out +=
            fmt::format(" <Grid Name=\"step {}\" GridType=\"Uniform\"><Time Value=\"{:.10g}\"/>\n", at.step, at.time);
        out += topology;
        out += fmt::format("  <Geometry GeometryType=\"XYZ\">{}</Geometry>\n", item(file + "points_mm", vectors));
        out += attribute("displacement_mm", "Vector", "Node", item(file + "displacement_mm", vectors));
        for (const char* name : {"J", "von_mises_kPa", "max_stretch", "energy_density_kPa"})
            out += attribute(name, "Scalar", "Cell", item(file + name, scalars));
        for (const char* name : {"region", "material"})
            out += attribute(name, "Scalar", "Cell", item(std::string("mesh.h5:/") + name, scalars, true));
        out += " </Grid>\n";
    }
    return out + "</Grid>\n</Domain></Xdmf>\n";
}

}  // namespace pliant::sim::distributed
