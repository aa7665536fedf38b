// VTK XML unstructured grids (.vtu). Format: VTK User's Guide, "XML file formats".
#include <libdeflate.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <span>
#include <utility>

#include "base/core/base64.hpp"
#include "base/core/parallel.hpp"
#include "geometry/files/tet_collector.hpp"
#include "geometry/files/tet_file.hpp"

namespace pliant::mesh {
namespace {

constexpr int vtk_tetra = 10;
constexpr int vtk_quadratic_tetra = 24;

/// Deflate shrinks by no more than this: a block that claims more is not believed.
constexpr std::size_t most_expansion = 1032;

constexpr std::size_t blocks_at_once = 16;
constexpr std::size_t numbers_at_once = std::size_t{1} << 16;

using Numbers = std::vector<double>;

struct Piece {
    Numbers points, connectivity, offsets, types, regions;
};

/// Begins what stands in for the text of an array: no XML file may hold it.
constexpr char stand_in = '\x01';

/// The text of an XML file without that of its large arrays, which a tree of the document need not hold. What stands
/// in for each is its number.
struct Skeleton {
    std::string xml;
    std::vector<std::string_view> arrays;
    struct Cut {
        std::size_t at, left_out;  ///< where in `xml`, and how many bytes up to there are missing
    };
    std::vector<Cut> cuts;

    /// Where in the file a place in the text is.
    [[nodiscard]] std::size_t in_file(std::size_t at) const {
        const auto next =
            std::upper_bound(cuts.begin(), cuts.end(), at, [](std::size_t a, const Cut& cut) { return a < cut.at; });
        return next == cuts.begin() ? at : at + (next - 1)->left_out;
    }
};

/// The end of a tag, past its '>': one in the value of an attribute does not count.
std::size_t end_of_tag(std::string_view text, std::size_t at) {
    char quote = 0;
    for (; at < text.size(); ++at) {
        const char c = text[at];
        if (quote != 0)
            quote = c == quote ? '\0' : quote;
        else if (c == '"' || c == '\'')
            quote = c;
        else if (c == '>')
            return at + 1;
    }
    return std::string_view::npos;
}

Skeleton without_arrays(std::string_view text) {
    constexpr std::string_view begin_of_array = "<DataArray";
    constexpr std::size_t small = 256;  // bytes, which are left where they are
    Skeleton result;
    std::size_t copied = 0;
    for (std::size_t tag = text.find(begin_of_array); tag != std::string_view::npos;
         tag = text.find(begin_of_array, tag)) {
        const std::size_t begin = end_of_tag(text, tag);
        tag = begin;
        if (begin == std::string_view::npos) break;
        const std::size_t end = text.find('<', begin);
        if (text[begin - 2] == '/' || end == std::string_view::npos || end - begin < small) continue;
        result.xml += text.substr(copied, begin - copied);
        result.xml += fmt::format("{}{}", stand_in, result.arrays.size());
        result.arrays.push_back(text.substr(begin, end - begin));
        copied = tag = end;
        result.cuts.push_back({result.xml.size(), end - result.xml.size()});
    }
    result.xml += text.substr(copied);
    return result;
}

/// A type of number in a file, by its name there.
struct NumberType {
    std::size_t width = 0;
    bool floating = false;
    bool is_signed = false;
};

std::optional<NumberType> number_type(std::string_view name) {
    if (name == "Float32") return NumberType{4, true, true};
    if (name == "Float64") return NumberType{8, true, true};
    if (name == "String") return NumberType{1, false, false};
    const bool is_signed = !name.starts_with("U");
    if (!is_signed) name.remove_prefix(1);
    if (name == "Int8") return NumberType{1, false, is_signed};
    if (name == "Int16") return NumberType{2, false, is_signed};
    if (name == "Int32") return NumberType{4, false, is_signed};
    if (name == "Int64") return NumberType{8, false, is_signed};
    return std::nullopt;
}

/// Where the bytes of an array come from: base64 text, or the bytes themselves.
struct Source {
    std::string_view text;
    bool base64 = true;

    [[nodiscard]] std::optional<std::string> first(std::size_t count) const {
        if (base64) return base64_decoded(text, count);
        if (count > text.size()) return std::nullopt;
        return std::string(text.substr(0, count));
    }
};

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

    /// Of a place in the skeleton.
    std::ptrdiff_t line_of(std::ptrdiff_t place) const {
        const std::size_t in_file = skeleton_.in_file(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, place)));
        const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(std::min(in_file, bytes_.size()));
        return 1 + std::count(bytes_.begin(), end, '\n');
    }

    /// The text of an array in the file.
    std::string_view text_of(const pugi::xml_node& array) const {
        const std::string_view text = array.child_value();
        if (!text.starts_with(stand_in)) return text;
        std::size_t number = 0;
        const auto [end, code] = std::from_chars(text.data() + 1, text.data() + text.size(), number);
        const bool known = code == std::errc() && end == text.data() + text.size() && number < skeleton_.arrays.size();
        return known ? skeleton_.arrays[number] : text;
    }

    /// Appended data may hold any bytes: the XML ends where they begin.
    Status load() {
        skeleton_ = without_arrays(bytes_.substr(0, bytes_.find("<AppendedData")));
        if (const std::size_t tag = bytes_.find("<AppendedData"); tag != std::string_view::npos) {
            const std::size_t end = bytes_.find('>', tag);
            const std::size_t mark = end == std::string_view::npos ? end : bytes_.find('_', end);
            if (mark == std::string_view::npos)
                return input_error("{}: the file ends in the middle of AppendedData", name_);
            appended_ = {bytes_.substr(mark + 1), bytes_.substr(tag, end - tag).find("raw") == std::string_view::npos};
            skeleton_.xml += std::string(bytes_.substr(tag, end + 1 - tag)) + "</AppendedData></VTKFile>";
        }
        const pugi::xml_parse_result result = document_.load_buffer(skeleton_.xml.data(), skeleton_.xml.size());
        if (result) return {};
        return input_error_at(name_, line_of(result.offset), "is not well-formed XML: {}", result.description());
    }

    Status read_encoding(const pugi::xml_node& file) {
        big_endian_ = std::string_view(file.attribute("byte_order").value()) == "BigEndian";
        header_width_ = std::string_view(file.attribute("header_type").value()) == "UInt64" ? 8 : 4;
        const std::string_view compressor = file.attribute("compressor").value();
        compressed_ = !compressor.empty();
        if (compressed_ && compressor != "vtkZLibDataCompressor")
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
        const auto type = number_type(array.attribute("type").value());
        if (!type) return error(array, fmt::format("unknown type \"{}\" of an array", array.attribute("type").value()));
        if (format == "ascii") return read_text(array, numbers);
        Source source{text_of(array), true};
        if (format == "appended") {
            const auto offset = array.attribute("offset").as_ullong();
            if (offset >= appended_.text.size())
                return error(array, "the offset of the array is past the end of the file");
            source = {appended_.text.substr(offset), appended_.base64};
        } else if (format != "binary") {
            return error(array, fmt::format("unknown format \"{}\" of an array", format));
        }
        const auto bytes = compressed_ ? decompressed(source) : plain(source);
        if (!bytes) return error(array, "the data of the array are damaged or cut off");
        decode_all(*type, *bytes, numbers);
        return {};
    }

    void decode_all(const NumberType& type, std::string_view bytes, Numbers& numbers) const {
        numbers.resize(bytes.size() / type.width);
        parallel_for(numbers.size(), numbers_at_once, [&](std::size_t begin, std::size_t end) {
            const auto as_they_are = [&]<class T>(T) {
                for (std::size_t i = begin; i < end; ++i) {
                    T value;
                    std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
                    numbers[i] = static_cast<double>(value);
                }
            };
            // The types of nearly all files, as this machine has them.
            if (!big_endian_ && type.floating && type.width == 8) return as_they_are(double{});
            if (!big_endian_ && type.floating) return as_they_are(float{});
            if (!big_endian_ && type.is_signed && type.width == 8) return as_they_are(std::int64_t{});
            if (!big_endian_ && type.is_signed && type.width == 4) return as_they_are(std::int32_t{});
            if (!type.is_signed && type.width == 1) return as_they_are(std::uint8_t{});
            for (std::size_t i = begin; i < end; ++i)
                numbers[i] = decode(type, bytes.substr(i * type.width, type.width));
        });
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

    [[nodiscard]] std::uint64_t bits(std::string_view bytes) const {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < bytes.size(); ++i)
            value = value << 8U | static_cast<unsigned char>(bytes[big_endian_ ? i : bytes.size() - 1 - i]);
        return value;
    }

    [[nodiscard]] double decode(const NumberType& type, std::string_view bytes) const {
        const std::uint64_t value = bits(bytes);
        if (type.floating && type.width == 4) return std::bit_cast<float>(static_cast<std::uint32_t>(value));
        if (type.floating) return std::bit_cast<double>(value);
        if (!type.is_signed) return static_cast<double>(value);
        const std::uint64_t sign = std::uint64_t{1} << (8 * type.width - 1);
        return static_cast<double>(static_cast<std::int64_t>((value ^ sign) - sign));
    }

    /// A count of bytes, then the bytes.
    [[nodiscard]] std::optional<std::string> plain(const Source& source) const {
        const auto header = source.first(header_width_);
        if (!header) return std::nullopt;
        const std::uint64_t count = bits(*header);
        if (count > source.text.size()) return std::nullopt;
        auto all = source.first(header_width_ + count);
        if (all) all->erase(0, header_width_);
        return all;
    }

    /// Number of blocks, their size, the size of a short last block or 0, compressed sizes; then the blocks.
    [[nodiscard]] std::optional<std::string> decompressed(const Source& source) const {
        const auto start = source.first(3 * header_width_);
        if (!start) return std::nullopt;
        const auto word = [&](const std::string& header, std::size_t i) {
            return bits(std::string_view(header).substr(i * header_width_, header_width_));
        };
        const std::uint64_t blocks = word(*start, 0);
        if (blocks > source.text.size()) return std::nullopt;
        const std::size_t header_bytes = header_width_ * (3 + blocks);
        const auto header = source.first(header_bytes);
        if (!header) return std::nullopt;
        std::size_t total = header_bytes;
        for (std::size_t b = 0; b < blocks; ++b) {
            if (word(*header, 3 + b) > source.text.size() - std::min(total, source.text.size())) return std::nullopt;
            total += word(*header, 3 + b);
        }
        const auto all = source.first(total);
        if (!all) return std::nullopt;
        std::string out;
        std::size_t at = header_bytes;
        std::vector<Block> some;
        for (std::size_t b = 0; b < blocks; ++b) {
            const bool short_one = b + 1 == blocks && word(*header, 2) != 0;
            const std::string_view packed = std::string_view(*all).substr(at, word(*header, 3 + b));
            const std::uint64_t size = word(*header, short_one ? 2 : 1);
            if (size > most_expansion * (packed.size() + 1)) return std::nullopt;
            some.push_back({packed, size});
            at += packed.size();
            if ((some.size() == blocks_at_once || b + 1 == blocks) && !inflate(std::exchange(some, {}), out))
                return std::nullopt;
        }
        return out;
    }

    struct Block {
        std::string_view packed;
        std::size_t size;  ///< unpacked
    };
    /// Appends some blocks, on all cores: no more than what a few of them claim is taken on trust.
    static bool inflate(const std::vector<Block>& blocks, std::string& out) {
        std::vector<std::size_t> begin = {out.size()};
        for (const Block& block : blocks) begin.push_back(begin.back() + block.size);
        out.resize(begin.back());
        std::atomic<bool> sound = true;
        parallel_for(blocks.size(), 1, [&](std::size_t first, std::size_t end) {
            for (std::size_t b = first; b < end; ++b) {
                if (!inflate(blocks[b].packed, {out.data() + begin[b], blocks[b].size})) sound = false;
            }
        });
        return sound;
    }

    static bool inflate(std::string_view packed, std::span<char> out) {
        const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> state(
            libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
        return libdeflate_zlib_decompress(state.get(), packed.data(), packed.size(), out.data(), out.size(), nullptr) ==
               LIBDEFLATE_SUCCESS;
    }

    /// Field data "region_names": character codes, each text ended by 0. Names are a courtesy: damaged ones are left
    /// out.
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

    static Result<TetMesh> assemble(const std::vector<Piece>& pieces,
                                    const std::map<std::int64_t, std::string>& names) {
        std::vector<Vec3> points;
        std::size_t numbers = 0;
        for (const Piece& piece : pieces) numbers += piece.points.size();
        points.reserve(numbers / 3);
        for (const Piece& piece : pieces) {
            for (std::size_t i = 0; i + 2 < piece.points.size(); i += 3)
                points.push_back({piece.points[i], piece.points[i + 1], piece.points[i + 2]});
        }
        TetCollector collector(std::move(points));
        std::size_t cells = 0, nodes = 0;
        for (const Piece& piece : pieces) {
            cells += piece.types.size();
            nodes += piece.connectivity.size();
        }
        collector.reserve(cells, nodes);
        std::int64_t first_point = 0;
        for (const Piece& piece : pieces) {
            if (Status status = add_piece(piece, first_point, collector); !status)
                return tl::unexpected(status.error());
            first_point += static_cast<std::int64_t>(piece.points.size() / 3);
        }
        return collector.finish(names);
    }

    static Status add_piece(const Piece& piece, std::int64_t first_point, TetCollector& collector) {
        const std::size_t points = piece.points.size() / 3;
        std::vector<std::int64_t> nodes;
        for (std::size_t c = 0; c < piece.types.size(); ++c) {
            if (piece.types[c] != vtk_tetra && piece.types[c] != vtk_quadratic_tetra) continue;
            const auto begin = static_cast<std::size_t>(c == 0 ? 0 : piece.offsets[c - 1]);
            const auto end = static_cast<std::size_t>(piece.offsets[c]);
            if (end - begin != (piece.types[c] == vtk_tetra ? 4 : 10))
                return input_error("cell {} has {} nodes", c, end - begin);
            nodes.clear();
            for (std::size_t i = begin; i < end; ++i) {
                const double node = piece.connectivity[i];
                if (!(node >= 0 && node < static_cast<double>(points) && node == std::floor(node)))
                    return input_error("cell {} names point {}, there are {}", c, node, points);
                nodes.push_back(first_point + static_cast<std::int64_t>(node));
            }
            const double region = piece.regions.empty() ? 0 : piece.regions[c];
            if (Status status = collector.add(nodes, static_cast<std::int64_t>(region)); !status)
                return input_error("cell {}: {}", c, status.error().message);
        }
        return {};
    }

    std::string_view bytes_;
    std::string name_;
    Skeleton skeleton_;
    pugi::xml_document document_;
    Source appended_;
    bool big_endian_ = false;
    bool compressed_ = false;
    std::size_t header_width_ = 4;
};

}  // namespace

Result<TetMesh> parse_vtu(std::string_view bytes, const std::string& name) {
    return VtuReader(bytes, name).read();
}

}  // namespace pliant::mesh
