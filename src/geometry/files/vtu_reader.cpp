// VTK XML unstructured grids (.vtu). Format: VTK User's Guide, "XML file formats".
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <pugixml.hpp>
#include <utility>

#include "geometry/files/tet_collector.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/vtk_cells.hpp"
#include "geometry/files/vtu_arrays.hpp"
#include "geometry/files/vtu_skeleton.hpp"
#include "geometry/mesh/point_welder.hpp"

namespace pliant::mesh {
namespace {

using Numbers = std::vector<double>;

struct Piece {
    Numbers points, connectivity, offsets, types, regions;
};

bool is_tet_cell(double type) {
    return type == vtk_tetra || type == vtk_quadratic_tetra;
}

/// Marks the points of the tets of a piece. Numbers of points that do not exist are told when the tets are added.
std::vector<bool> used_points(const Piece& piece) {
    std::vector<bool> used(piece.points.size() / 3, false);
    for (std::size_t c = 0; c < piece.types.size(); ++c) {
        if (!is_tet_cell(piece.types[c])) continue;
        const auto end = static_cast<std::size_t>(piece.offsets[c]);
        for (auto i = static_cast<std::size_t>(c == 0 ? 0 : piece.offsets[c - 1]); i < end; ++i) {
            const double node = piece.connectivity[i];
            if (node >= 0 && node < static_cast<double>(used.size())) used[static_cast<std::size_t>(node)] = true;
        }
    }
    return used;
}

/// Which point stands for each point of a file: programs that divide a mesh into pieces repeat the points between them.
struct SharedPoints {
    std::vector<std::int64_t> instead;  ///< (points of all pieces)
    std::size_t joined = 0;             ///< points that have another one instead
};

/// Points of tets at exactly the same place in several pieces become one. Where one piece has several there, as along a
/// crack, nobody knows which of them belongs to which of another piece: these stay apart.
SharedPoints share_points(const std::vector<Piece>& pieces, const std::vector<Vec3>& points) {
    constexpr std::int64_t nobody = -1, many = -2;
    PointWelder places;
    std::vector<int> place(points.size(), -1);
    std::vector<std::int64_t> last_piece, first_point;  // (places)
    std::size_t point = 0;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        const auto own = static_cast<std::int64_t>(p);
        for (const bool used : used_points(pieces[p])) {
            if (used) {
                place[point] = places.add(points[point]);
                const auto at = static_cast<std::size_t>(place[point]);
                if (at == last_piece.size()) {
                    last_piece.push_back(nobody);
                    first_point.push_back(static_cast<std::int64_t>(point));
                }
                last_piece[at] = last_piece[at] == own || last_piece[at] == many ? many : own;
            }
            ++point;
        }
    }
    SharedPoints shared;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto own = static_cast<std::int64_t>(i);
        const bool alone = place[i] < 0 || last_piece[static_cast<std::size_t>(place[i])] == many;
        shared.instead.push_back(alone ? own : first_point[static_cast<std::size_t>(place[i])]);
        if (shared.instead.back() != own) ++shared.joined;
    }
    return shared;
}

/// `instead`: empty, or which point stands for each of the file.
Status add_piece(const Piece& piece, std::int64_t first_point, const std::vector<std::int64_t>& instead,
                 TetCollector& collector) {
    const std::size_t points = piece.points.size() / 3;
    std::vector<std::int64_t> nodes;
    for (std::size_t c = 0; c < piece.types.size(); ++c) {
        if (!is_tet_cell(piece.types[c])) continue;
        const auto begin = static_cast<std::size_t>(c == 0 ? 0 : piece.offsets[c - 1]);
        const auto end = static_cast<std::size_t>(piece.offsets[c]);
        if (end - begin != (piece.types[c] == vtk_tetra ? 4 : 10))
            return input_error("cell {} has {} nodes", c, end - begin);
        nodes.clear();
        for (std::size_t i = begin; i < end; ++i) {
            const double node = piece.connectivity[i];
            if (!(node >= 0 && node < static_cast<double>(points) && node == std::floor(node)))
                return input_error("cell {} names point {}, there are {}", c, node, points);
            const std::int64_t point = first_point + static_cast<std::int64_t>(node);
            nodes.push_back(instead.empty() ? point : instead[static_cast<std::size_t>(point)]);
        }
        const double region = piece.regions.empty() ? 0 : piece.regions[c];
        if (Status status = collector.add(nodes, static_cast<std::int64_t>(region)); !status)
            return input_error("cell {}: {}", c, status.error().message);
    }
    return {};
}

Result<TetMesh> assemble(const std::vector<Piece>& pieces, const std::map<std::int64_t, std::string>& names) {
    std::vector<Vec3> points;
    std::size_t numbers = 0;
    for (const Piece& piece : pieces) numbers += piece.points.size();
    points.reserve(numbers / 3);
    for (const Piece& piece : pieces) {
        for (std::size_t i = 0; i + 2 < piece.points.size(); i += 3)
            points.push_back({piece.points[i], piece.points[i + 1], piece.points[i + 2]});
    }
    const SharedPoints shared = pieces.size() > 1 ? share_points(pieces, points) : SharedPoints{};
    TetCollector collector(std::move(points));
    std::size_t cells = 0, nodes = 0;
    for (const Piece& piece : pieces) {
        cells += piece.types.size();
        nodes += piece.connectivity.size();
    }
    collector.reserve(cells, nodes);
    std::int64_t first_point = 0;
    for (const Piece& piece : pieces) {
        if (Status status = add_piece(piece, first_point, shared.instead, collector); !status)
            return tl::unexpected(status.error());
        first_point += static_cast<std::int64_t>(piece.points.size() / 3);
    }
    Result<TetMesh> mesh = collector.finish(names);
    if (mesh && shared.joined > 0)
        mesh->notes.insert(mesh->notes.begin(),
                           fmt::format("{} points of its {} pieces lie exactly at points of other pieces: they were "
                                       "joined with them",
                                       shared.joined, pieces.size()));
    return mesh;
}

class VtuReader {
public:
    VtuReader(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

    Result<TetMesh> read() {
        if (Status status = load(); !status) return tl::unexpected(status.error());
        const pugi::xml_node file = document_.child("VTKFile");
        const pugi::xml_node grid = file.child("UnstructuredGrid");
        if (!grid) return error(file, "only VTKFile type=\"UnstructuredGrid\" holds tetrahedra");
        if (Status status = read_encoding(file); !status) return tl::unexpected(status.error());
        std::vector<Piece> pieces;
        for (const pugi::xml_node piece : grid.children("Piece")) {
            pieces.emplace_back();
            if (Status status = read_piece(piece, pieces.back()); !status) return tl::unexpected(status.error());
        }
        Result<TetMesh> mesh = assemble(pieces, read_names(grid));
        if (!mesh) return error(grid, mesh.error().message);
        return mesh;
    }

private:
    tl::unexpected<Error> error(const pugi::xml_node& where, std::string_view text) const {
        return input_error_at(name_, line_of(where.offset_debug()), "{}", text);
    }

    /// The line of an offset in the skeleton.
    std::ptrdiff_t line_of(std::ptrdiff_t place) const {
        const std::size_t in_file =
            skeleton_.place_in_file(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, place)));
        const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(std::min(in_file, bytes_.size()));
        return 1 + std::count(bytes_.begin(), end, '\n');
    }

    [[nodiscard]] std::string_view text_of(const pugi::xml_node& array) const {
        return skeleton_.original(array.child_value());
    }

    /// Appended data may contain any bytes: the XML ends where they begin.
    Status load() {
        skeleton_ = VtuSkeleton(bytes_.substr(0, bytes_.find("<AppendedData")));
        if (const std::size_t tag = bytes_.find("<AppendedData"); tag != std::string_view::npos) {
            const std::size_t end = bytes_.find('>', tag);
            const std::size_t mark = end == std::string_view::npos ? end : bytes_.find('_', end);
            if (mark == std::string_view::npos)
                return input_error("{}: the file ends in the middle of AppendedData", name_);
            appended_ = {bytes_.substr(mark + 1), bytes_.substr(tag, end - tag).find("raw") == std::string_view::npos};
            skeleton_.append(bytes_.substr(tag, end + 1 - tag));
            skeleton_.append("</AppendedData></VTKFile>");
        }
        const pugi::xml_parse_result result = document_.load_buffer(skeleton_.xml().data(), skeleton_.xml().size());
        if (result) return {};
        return input_error_at(name_, line_of(result.offset), "is not well-formed XML: {}", result.description());
    }

    Status read_encoding(const pugi::xml_node& file) {
        encoding_.big_endian = std::string_view(file.attribute("byte_order").value()) == "BigEndian";
        encoding_.header_width = std::string_view(file.attribute("header_type").value()) == "UInt64" ? 8 : 4;
        const std::string_view compressor = file.attribute("compressor").value();
        encoding_.compressed = !compressor.empty();
        if (encoding_.compressed && compressor != "vtkZLibDataCompressor")
            return error(file,
                         fmt::format("compressor \"{}\" is not read; vtkZLibDataCompressor or none is", compressor));
        return {};
    }

    Status read_piece(const pugi::xml_node& node, Piece& piece) const {
        const pugi::xml_node cells = node.child("Cells");
        struct Wanted {
            pugi::xml_node array;
            std::string_view what;
            Numbers* into;
        };
        const auto named = [&](const char* name) { return cells.find_child_by_attribute("DataArray", "Name", name); };
        for (const Wanted& wanted : {Wanted{node.child("Points").child("DataArray"), "Points", &piece.points},
                                     Wanted{named("connectivity"), "Cells connectivity", &piece.connectivity},
                                     Wanted{named("offsets"), "Cells offsets", &piece.offsets},
                                     Wanted{named("types"), "Cells types", &piece.types}}) {
            if (!wanted.array) return error(node, fmt::format("the array {} is missing", wanted.what));
            if (Status status = read_array(wanted.array, *wanted.into); !status) return status;
        }
        for (const char* name : {"region", "material", "medit:ref", "gmsh:physical"}) {
            const auto array = node.child("CellData").find_child_by_attribute("DataArray", "Name", name);
            if (!array || !piece.regions.empty()) continue;
            if (Status status = read_array(array, piece.regions); !status) return status;
            const auto whole = [](double v) { return v == std::floor(v) && std::fabs(v) < 1e9; };
            if (piece.regions.size() != piece.types.size() ||
                !std::all_of(piece.regions.begin(), piece.regions.end(), whole))
                piece.regions.clear();
        }
        return check_piece(node, piece);
    }

    Status check_piece(const pugi::xml_node& node, const Piece& piece) const {
        if (piece.points.size() % 3 != 0) return error(node, "the coordinates of the points are not whole triples");
        for (std::size_t i = 0; i < piece.points.size(); ++i) {
            if (!std::isfinite(piece.points[i])) return error(node, fmt::format("point {} is not finite", i / 3));
        }
        if (piece.offsets.size() != piece.types.size())
            return error(node,
                         fmt::format("{} offsets but {} types of cells", piece.offsets.size(), piece.types.size()));
        double before = 0;
        for (const double offset : piece.offsets) {
            if (!(offset >= before && offset <= static_cast<double>(piece.connectivity.size()) &&
                  offset == std::floor(offset)))
                return error(node, "the offsets of the cells do not fit their connectivity");
            before = offset;
        }
        return {};
    }

    Status read_array(const pugi::xml_node& array, Numbers& numbers) const {
        const std::string_view format = array.attribute("format").value();
        const auto type = vtu_number_type(array.attribute("type").value());
        if (!type) return error(array, fmt::format("unknown type \"{}\" of an array", array.attribute("type").value()));
        if (format == "ascii") return read_text(array, numbers);
        VtuSource source{text_of(array), true};
        if (format == "appended") {
            const auto offset = array.attribute("offset").as_ullong();
            if (offset >= appended_.text.size())
                return error(array, "the offset of the array is past the end of the file");
            source = {appended_.text.substr(offset), appended_.base64};
        } else if (format != "binary") {
            return error(array, fmt::format("unknown format \"{}\" of an array", format));
        }
        auto decoded = vtu_numbers(source, *type, encoding_);
        if (!decoded) return error(array, "the data of the array are damaged or cut off");
        numbers = std::move(*decoded);
        return {};
    }

    Status read_text(const pugi::xml_node& array, Numbers& numbers) const {
        const std::string_view text = text_of(array);
        constexpr std::string_view blanks = " \t\r\n";
        for (std::size_t at = text.find_first_not_of(blanks); at != std::string_view::npos;
             at = text.find_first_not_of(blanks, at)) {
            const std::size_t end = std::min(text.find_first_of(blanks, at), text.size());
            double value = 0;
            const auto [last, code] = std::from_chars(text.data() + at, text.data() + end, value);
            if (code != std::errc() || last != text.data() + end)
                return error(
                    array, fmt::format("\"{}\" is not a number", text.substr(at, std::min<std::size_t>(end - at, 40))));
            numbers.push_back(value);
            at = end;
        }
        return {};
    }

    /// Field data "region_names": character codes, each name ended by 0. Names are optional: damaged ones are left out.
    [[nodiscard]] std::map<std::int64_t, std::string> read_names(const pugi::xml_node& grid) const {
        std::map<std::int64_t, std::string> names;
        const auto array = grid.child("FieldData").find_child_by_attribute("DataArray", "Name", "region_names");
        Numbers codes;
        if (!array || !read_array(array, codes)) return names;
        std::string name;
        for (const double code : codes) {
            if (code > 0 && code < 256) {
                name += static_cast<char>(static_cast<unsigned char>(code));
            } else {
                const auto number = static_cast<std::int64_t>(names.size());
                names[number] = std::move(name);
                name.clear();
            }
        }
        return names;
    }

    std::string_view bytes_;
    std::string name_;
    VtuSkeleton skeleton_;
    pugi::xml_document document_;
    VtuSource appended_;
    VtuEncoding encoding_;
};

}  // namespace

Result<TetMesh> parse_vtu(std::string_view bytes, const std::string& name) {
    return VtuReader(bytes, name).read();
}

}  // namespace pliant::mesh
