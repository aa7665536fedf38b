// Legacy VTK files. Format: VTK User's Guide, "Simple legacy formats". Bytes are big-endian.
#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "base/core/byte_order.hpp"
#include "geometry/files/tet_writer.hpp"
#include "geometry/files/vtk_cells.hpp"

namespace pliant::mesh {
namespace {

/// Names in legacy VTK files are words without commas: blanks and some other characters become %XX.
std::string percent_encoded(std::string_view text) {
    std::string out;
    for (const char c : text) {
        const bool plain = c > ' ' && c < 127 && c != '%' && c != '"' && c != ',';
        out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return out;
}

/// Title and data type. The region names are in the title, because Gmsh and others fail on a field before the points;
/// only names too long for a title (256 characters) are written as a field.
std::string head(const TetMesh& mesh, Encoding encoding) {
    constexpr std::size_t longest_title = 255;
    std::vector<std::string> names;
    for (const std::string& name : mesh.region_names) names.push_back(percent_encoded(name));
    const std::string title = fmt::format("{}{}", vtk_title_mark, fmt::join(names, ","));
    const bool fits = title.size() <= longest_title;
    std::string text =
        fmt::format("# vtk DataFile Version 3.0\n{}\n{}\nDATASET UNSTRUCTURED_GRID\n",
                    fits ? title : std::string("pliant tet mesh"), encoding == Encoding::text ? "ASCII" : "BINARY");
    if (fits) return text;
    text += fmt::format("FIELD FieldData 1\nregion_names 1 {} string\n", names.size());
    for (const std::string& name : names) {
        if (encoding == Encoding::text) {
            text += name + '\n';
            continue;
        }
        // The top two bits of the first byte give the number of bytes of the length: 2 means two bytes.
        const auto length = static_cast<unsigned>(std::min<std::size_t>(name.size(), 16383));
        text += static_cast<char>(static_cast<unsigned char>(0x80U | length >> 8U));
        text += static_cast<char>(static_cast<unsigned char>(length & 0xffU));
        text += name.substr(0, length);
    }
    if (encoding == Encoding::binary) text += '\n';
    return text;
}

/// Appends numbers as text, `per_line` on a line, or as big-endian bytes.
class NumberWriter {
public:
    NumberWriter(std::string& out, Encoding encoding) : out_(out), encoding_(encoding) {}

    void integer(int value, char separator) {
        if (encoding_ == Encoding::text)
            fmt::format_to(std::back_inserter(out_), "{}{}", value, separator);
        else
            append(byte_swapped(static_cast<std::uint32_t>(value)));
    }
    void real(double value, char separator) {
        if (encoding_ == Encoding::text)
            fmt::format_to(std::back_inserter(out_), "{}{}", value, separator);
        else
            append(byte_swapped(std::bit_cast<std::uint64_t>(value)));
    }
    void end_of_array() {
        if (encoding_ == Encoding::binary) out_ += '\n';
    }

private:
    template <class Bits>
    void append(Bits bits) {
        char bytes[sizeof(Bits)];
        std::memcpy(bytes, &bits, sizeof(Bits));
        out_.append(bytes, sizeof(Bits));
    }
    std::string& out_;
    Encoding encoding_;
};

}  // namespace

std::string vtk_bytes(const TetMesh& mesh, Encoding encoding) {
    static_assert(std::endian::native == std::endian::little, "bytes are turned round for the file");
    std::string text = head(mesh, encoding);
    const std::size_t tets = mesh.tet_count();
    const auto width = static_cast<std::size_t>(mesh.nodes_per_tet());
    text.reserve(text.size() + 24 * mesh.points.size() + (4 * width + 12) * tets + 1000);
    NumberWriter numbers(text, encoding);
    text += fmt::format("POINTS {} double\n", mesh.points.size());
    for (const Vec3& p : mesh.points) {
        numbers.real(p.x, ' ');
        numbers.real(p.y, ' ');
        numbers.real(p.z, '\n');
    }
    numbers.end_of_array();
    text += fmt::format("CELLS {} {}\n", tets, tets * (width + 1));
    for (std::size_t t = 0; t < tets; ++t) {
        numbers.integer(static_cast<int>(width), ' ');
        for (std::size_t a = 0; a < width; ++a) numbers.integer(mesh.tet(t)[a], a + 1 == width ? '\n' : ' ');
    }
    numbers.end_of_array();
    text += fmt::format("CELL_TYPES {}\n", tets);
    for (std::size_t t = 0; t < tets; ++t) numbers.integer(mesh.order == 2 ? vtk_quadratic_tetra : vtk_tetra, '\n');
    numbers.end_of_array();
    text += fmt::format("CELL_DATA {}\nSCALARS region int 1\nLOOKUP_TABLE default\n", tets);
    for (const int region : mesh.region) numbers.integer(region, '\n');
    numbers.end_of_array();
    return text;
}

}  // namespace pliant::mesh
