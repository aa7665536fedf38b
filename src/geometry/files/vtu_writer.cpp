#include "geometry/files/vtu_writer.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <string_view>
#include <type_traits>

#include "base/core/base64.hpp"
#include "base/core/files.hpp"
#include "geometry/files/vtk_cells.hpp"

namespace pliant::mesh {
namespace {

static_assert(std::endian::native == std::endian::little, "the files are declared LittleEndian");

constexpr std::size_t block_bytes = std::size_t{1} << 18;
constexpr int compression_level = 1;

template <class T>
std::string_view as_bytes(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

template <class T>
constexpr std::string_view type_name() {
    if constexpr (std::is_same_v<T, float>) return "Float32";
    if constexpr (std::is_same_v<T, double>) return "Float64";
    if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
    return "UInt8";
}

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

class Compressor {
public:
    Compressor() : state_(libdeflate_alloc_compressor(compression_level), &libdeflate_free_compressor) {}

    /// vtkZLibDataCompressor: the header (number of blocks, block size, size of a short last block or 0, compressed
    /// sizes) and the blocks, each encoded separately as base64.
    [[nodiscard]] std::string encode(std::string_view bytes) const {
        std::vector<std::uint64_t> header = {(bytes.size() + block_bytes - 1) / block_bytes, block_bytes,
                                             bytes.size() % block_bytes};
        std::string blocks;
        for (std::size_t at = 0; at < bytes.size(); at += block_bytes) {
            const std::string_view block = bytes.substr(at, block_bytes);
            const std::size_t begin = blocks.size();
            blocks.resize(begin + libdeflate_zlib_compress_bound(state_.get(), block.size()));
            const std::size_t size = libdeflate_zlib_compress(state_.get(), block.data(), block.size(),
                                                              blocks.data() + begin, blocks.size() - begin);
            blocks.resize(begin + size);
            header.push_back(size);
        }
        return base64(as_bytes(header)) + base64(blocks);
    }

private:
    std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> state_;
};

template <class T>
std::string data_array(const Compressor& compressor, std::string_view name, int components,
                       const std::vector<T>& values) {
    return fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">\n{}\n</DataArray>\n",
        type_name<T>(), escaped(name), components, compressor.encode(as_bytes(values)));
}

Result<std::string> data_arrays(const Compressor& compressor, const std::vector<VtuArray>& arrays, std::size_t items) {
    std::string text;
    for (const VtuArray& array : arrays) {
        const std::size_t size = std::visit([](const auto& values) { return values.size(); }, array.values);
        if (array.components < 1 || size != items * static_cast<std::size_t>(array.components)) {
            return input_error("VTK array \"{}\": {} values, but {} items of {} components are needed", array.name,
                               size, items, array.components);
        }
        text +=
            std::visit([&](const auto& values) { return data_array(compressor, array.name, array.components, values); },
                       array.values);
    }
    return text;
}

std::string cells_text(const Compressor& compressor, const TetMesh& mesh) {
    const std::vector<std::int32_t> connectivity(mesh.nodes.begin(), mesh.nodes.end());
    std::vector<std::int32_t> offsets(mesh.tet_count());
    for (std::size_t t = 0; t < offsets.size(); ++t) {
        offsets[t] = static_cast<std::int32_t>(t + 1) * mesh.nodes_per_tet();
    }
    const std::vector<std::uint8_t> types(mesh.tet_count(), mesh.order == 2 ? vtk_quadratic_tetra : vtk_tetra);
    return data_array(compressor, "connectivity", 1, connectivity) + data_array(compressor, "offsets", 1, offsets) +
           data_array(compressor, "types", 1, types);
}

/// Character codes, each name ended by 0. As numbers, because other readers fail on arrays of type String.
std::string names_text(const std::vector<std::string>& names) {
    if (names.empty()) return "";
    std::string codes;
    std::size_t count = 0;
    for (const std::string& name : names) {
        count += name.size() + 1;
        for (const unsigned char c : name) codes += fmt::format("{} ", static_cast<int>(c));
        codes += "0 ";
    }
    return fmt::format(
        "<FieldData>\n<DataArray type=\"UInt8\" Name=\"region_names\" NumberOfTuples=\"{}\" "
        "format=\"ascii\">\n{}\n</DataArray>\n</FieldData>\n",
        count, codes);
}

std::string points_text(const Compressor& compressor, std::span<const Vec3> points) {
    std::vector<double> coordinates;
    coordinates.reserve(3 * points.size());
    for (const Vec3& p : points) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
    return data_array(compressor, "Points", 3, coordinates);
}

}  // namespace

Result<std::string> vtu_text(const TetMesh& mesh, std::span<const Vec3> points, const VtuData& data) {
    if (points.size() != mesh.points.size()) {
        return input_error("VTK file: {} positions for a mesh of {} points", points.size(), mesh.points.size());
    }
    const Compressor compressor;
    const auto point_data = data_arrays(compressor, data.points, points.size());
    if (!point_data) return point_data;
    const auto cell_data = data_arrays(compressor, data.cells, mesh.tet_count());
    if (!cell_data) return cell_data;
    return fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
        "compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n"
        "{}<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n"
        "<Points>\n{}</Points>\n<Cells>\n{}</Cells>\n<PointData>\n{}</PointData>\n<CellData>\n{}</CellData>\n"
        "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
        names_text(data.region_names), points.size(), mesh.tet_count(), points_text(compressor, points),
        cells_text(compressor, mesh), *point_data, *cell_data);
}

Status write_vtu(const std::filesystem::path& path, const TetMesh& mesh, std::span<const Vec3> points,
                 const VtuData& data) {
    const auto text = vtu_text(mesh, points, data);
    if (!text) return tl::unexpected(text.error());
    return write_file(path, *text);
}

}  // namespace pliant::mesh
