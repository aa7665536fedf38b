// Legacy VTK files: text lines, and arrays as text or big-endian bytes.
// Format: VTK User's Guide, "Simple legacy formats"; version 5 keeps offsets and connectivity apart.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <set>

#include "base/core/byte_order.hpp"
#include "geometry/files/tet_collector.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/tet_writer.hpp"

namespace pliant::mesh {
namespace {

constexpr int vtk_tetra = 10;
constexpr int vtk_quadratic_tetra = 24;

/// Reads a legacy VTK file front to back: words, and arrays that are text or big-endian bytes.
class VtkReader {
public:
    VtkReader(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

    Result<TetMesh> read() {
        if (Status status = read_header(); !status) return tl::unexpected(status.error());
        for (std::string word = next_word(); !word.empty(); word = next_word()) {
            Status status;
            if (word == "POINTS")
                status = read_points();
            else if (word == "CELLS")
                status = read_cells();
            else if (word == "CELL_TYPES")
                status = read_types();
            else if (word == "CELL_DATA")
                data_of_cells_ = true, status = read_count(data_count_);
            else if (word == "POINT_DATA")
                data_of_cells_ = false, status = read_count(data_count_);
            else if (word == "SCALARS")
                status = read_scalars();
            else if (word == "FIELD")
                status = read_field();
            else if (word == "VECTORS" || word == "NORMALS")
                status = skip_array(3);
            else if (word == "TENSORS")
                status = skip_array(9);
            else if (word == "COLOR_SCALARS")
                status = skip_colors();
            else if (word == "LOOKUP_TABLE")
                status = skip_lookup_table();
            else if (word == "TEXTURE_COORDINATES")
                status = skip_texture_coordinates();
            else if (word == "GLOBAL_IDS" || word == "PEDIGREE_IDS")
                status = skip_array(1);
            else if (word == "METADATA")
                skip_metadata();
            else
                return error("\"" + word.substr(0, 40) + "\" is not understood");
            if (!status) return tl::unexpected(status.error());
        }
        return assemble();
    }

private:
    tl::unexpected<Error> error(const std::string& text) const { return input_error_at(name_, line(), "{}", text); }
    [[nodiscard]] int line() const {
        return 1 +
               static_cast<int>(std::count(
                   bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, bytes_.size())), '\n'));
    }

    std::string_view next_line() {
        const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
        std::string_view text = bytes_.substr(at_, end - at_);
        at_ = std::min(end + 1, bytes_.size());
        if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
        return text;
    }

    static bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

    std::string next_word() {
        while (at_ < bytes_.size() && is_blank(bytes_[at_])) ++at_;
        const std::size_t begin = at_;
        while (at_ < bytes_.size() && !is_blank(bytes_[at_])) ++at_;
        return std::string(bytes_.substr(begin, at_ - begin));
    }

    Status read_header() {
        if (!next_line().starts_with("# vtk DataFile Version"))
            return input_error("{}: is not a legacy VTK file", name_);
        read_title(next_line());
        std::string_view encoding = next_line();
        while (!encoding.empty() && is_blank(encoding.back())) encoding.remove_suffix(1);
        if (encoding == "BINARY")
            binary_ = true;
        else if (encoding != "ASCII")
            return error("the third line must be ASCII or BINARY");
        if (next_word() != "DATASET" || next_word() != "UNSTRUCTURED_GRID")
            return error("only DATASET UNSTRUCTURED_GRID holds tetrahedra");
        return {};
    }

    void read_title(std::string_view title) {
        if (!title.starts_with(vtk_title_mark)) return;
        title.remove_prefix(vtk_title_mark.size());
        for (std::int64_t i = 0; !title.empty(); ++i) {
            const std::size_t comma = std::min(title.find(','), title.size());
            region_names_[i] = percent_decoded(title.substr(0, comma));
            title.remove_prefix(std::min(comma + 1, title.size()));
        }
    }

    Status read_count(std::size_t& count) {
        const std::string word = next_word();
        const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), count);
        if (code == std::errc() && end == word.data() + word.size()) return {};
        return error("a count is needed instead of \"" + word.substr(0, 40) + "\"");
    }

    /// A type of number, by its name in a file. Width 0: unknown.
    struct NumberType {
        std::size_t width = 0;
        bool floating = false;
        bool is_signed = true;
    };
    static NumberType number_type(const std::string& name) {
        static const std::map<std::string, NumberType> types = {
            {"float", {4, true}},
            {"double", {8, true}},
            {"int", {4}},
            {"unsigned_int", {4, false, false}},
            {"long", {8}},
            {"unsigned_long", {8, false, false}},
            {"vtktypeint64", {8}},
            {"vtkIdType", {8}},
            {"vtktypeuint64", {8, false, false}},
            {"vtktypeint32", {4}},
            {"short", {2}},
            {"unsigned_short", {2, false, false}},
            {"char", {1}},
            {"unsigned_char", {1, false, false}},
        };
        const auto found = types.find(name);
        return found == types.end() ? NumberType{} : found->second;
    }

    /// The bytes at a place, big-endian.
    [[nodiscard]] std::uint64_t bits(std::size_t width, std::size_t at) const {
        if (width == 8) {
            std::uint64_t value = 0;
            std::memcpy(&value, bytes_.data() + at, 8);
            return byte_swapped(value);
        }
        if (width == 4) {
            std::uint32_t value = 0;
            std::memcpy(&value, bytes_.data() + at, 4);
            return byte_swapped(value);
        }
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < width; ++i) value = value << 8U | static_cast<unsigned char>(bytes_[at + i]);
        return value;
    }

    [[nodiscard]] double decode(const NumberType& type, std::size_t at) const {
        const std::uint64_t value = bits(type.width, at);
        if (type.floating && type.width == 4) return std::bit_cast<float>(static_cast<std::uint32_t>(value));
        if (type.floating) return std::bit_cast<double>(value);
        if (!type.is_signed) return static_cast<double>(value);
        const std::uint64_t sign = std::uint64_t{1} << (8 * type.width - 1);
        return static_cast<double>(static_cast<std::int64_t>((value ^ sign) - sign));
    }

    /// `count` numbers of a type; memory follows what the file holds, not what it claims.
    Result<std::vector<double>> read_numbers(std::size_t count, const std::string& type_name) {
        const NumberType type = number_type(type_name);
        const std::size_t width = type.width;
        if (width == 0) return error("unknown data type \"" + type_name.substr(0, 40) + "\"");
        if (binary_ && at_ < bytes_.size() && bytes_[at_] == '\r') ++at_;
        if (binary_ && at_ < bytes_.size() && bytes_[at_] == '\n') ++at_;
        const std::size_t left = bytes_.size() - at_;
        std::vector<double> numbers;
        if (binary_) {
            if (count > left / width) return error(fmt::format("{} values are announced, the file ends before", count));
            numbers.reserve(count);
            for (std::size_t i = 0; i < count; ++i, at_ += width) numbers.push_back(decode(type, at_));
            return numbers;
        }
        if (count > left / 2 + 1) return error(fmt::format("{} values are announced, the file ends before", count));
        numbers.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            const std::string word = next_word();
            const char* begin = word.data() + (!word.empty() && word.front() == '+' ? 1 : 0);
            double value = 0;
            const auto [end, code] = std::from_chars(begin, word.data() + word.size(), value);
            if (word.empty() || code != std::errc() || end != word.data() + word.size()) {
                return error(word.empty() ? "the file ends in the middle of an array"
                                          : "\"" + word.substr(0, 40) + "\" is not a number");
            }
            numbers.push_back(value);
        }
        return numbers;
    }

    Status read_points() {
        std::size_t count = 0;
        if (Status status = read_count(count); !status) return status;
        const std::string type = next_word();
        if (count > bytes_.size()) return error("more points are announced than the file can hold");
        const Result<std::vector<double>> numbers = read_numbers(3 * count, type);
        if (!numbers) return tl::unexpected(numbers.error());
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 p{(*numbers)[3 * i], (*numbers)[3 * i + 1], (*numbers)[3 * i + 2]};
            if (!is_finite(p)) return error(fmt::format("point {} is not finite", i));
            points_.push_back(p);
        }
        return {};
    }

    /// Up to version 4: "CELLS n size", each cell its node count and nodes. From 5: offsets and connectivity apart.
    Status read_cells() {
        std::size_t count = 0;
        std::size_t size = 0;
        if (Status status = read_count(count); !status) return status;
        if (Status status = read_count(size); !status) return status;
        const std::size_t mark = at_;
        if (next_word() == "OFFSETS") return read_offset_cells(count, size);
        at_ = mark;
        const Result<std::vector<double>> list = read_numbers(size, "int");
        if (!list) return tl::unexpected(list.error());
        std::size_t at = 0;
        for (std::size_t c = 0; c < count; ++c) {
            const double nodes = at < size ? (*list)[at] : -1;
            if (!(nodes >= 0 && nodes <= static_cast<double>(size - at - 1)))
                return error(fmt::format("cell {} runs past the end of the list", c));
            if (Status status = add_cell(*list, at + 1, at + 1 + static_cast<std::size_t>(nodes)); !status)
                return status;
            at += 1 + static_cast<std::size_t>(nodes);
        }
        return {};
    }

    /// Appends the nodes [begin, end) of a list as one cell.
    Status add_cell(const std::vector<double>& list, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!(list[i] >= 0 && list[i] < 9e15 && list[i] == std::floor(list[i])))
                return error(fmt::format("cell {} names point {}", cells_.size() - 1, list[i]));
            connectivity_.push_back(static_cast<std::int64_t>(list[i]));
        }
        cells_.push_back(connectivity_.size());
        return {};
    }

    Status read_offset_cells(std::size_t offsets, std::size_t size) {
        const std::string offset_type = next_word();
        const Result<std::vector<double>> starts = read_numbers(offsets, offset_type);
        if (!starts) return tl::unexpected(starts.error());
        if (next_word() != "CONNECTIVITY") return error("CONNECTIVITY is needed after OFFSETS");
        const std::string type = next_word();
        const Result<std::vector<double>> list = read_numbers(size, type);
        if (!list) return tl::unexpected(list.error());
        for (std::size_t c = 0; c + 1 < offsets; ++c) {
            const double begin = (*starts)[c];
            const double end = (*starts)[c + 1];
            if (!(begin >= 0 && end >= begin && end <= static_cast<double>(size)))
                return error(fmt::format("cell {} runs past the end of the list", c));
            Status status = add_cell(*list, static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
            if (!status) return status;
        }
        return {};
    }

    Status read_types() {
        std::size_t count = 0;
        if (Status status = read_count(count); !status) return status;
        const Result<std::vector<double>> numbers = read_numbers(count, "int");
        if (!numbers) return tl::unexpected(numbers.error());
        types_ = *numbers;
        return {};
    }

    void keep_region(const std::string& name, std::vector<double> values) {
        static const std::set<std::string> names = {"region", "material", "medit:ref", "gmsh:physical"};
        const bool whole = std::all_of(values.begin(), values.end(),
                                       [](double v) { return v == std::floor(v) && std::fabs(v) < 1e9; });
        if (data_of_cells_ && names.contains(name) && whole) region_values_ = std::move(values);
    }

    Status read_scalars() {
        const std::string name = next_word();
        const std::string type = next_word();
        std::size_t components = 1;
        const std::string_view rest = next_line();
        if (rest.find_first_of("1234") != std::string_view::npos)
            components = static_cast<std::size_t>(rest[rest.find_first_of("1234")] - '0');
        const std::size_t mark = at_;
        if (next_word() == "LOOKUP_TABLE")
            next_line();
        else
            at_ = mark;
        if (binary_) --at_;  // the line end before the bytes
        Result<std::vector<double>> numbers = read_numbers(components * std::min(data_count_, bytes_.size()), type);
        if (!numbers) return tl::unexpected(numbers.error());
        keep_region(name, std::move(*numbers));
        return {};
    }

    Status read_field() {
        next_word();
        std::size_t arrays = 0;
        if (Status status = read_count(arrays); !status) return status;
        for (std::size_t a = 0; a < arrays; ++a) {
            const std::string name = next_word();
            if (name.empty()) return error("the file ends in the middle of a FIELD");
            std::size_t components = 0;
            std::size_t tuples = 0;
            if (Status status = read_count(components); !status) return status;
            if (Status status = read_count(tuples); !status) return status;
            const std::string type = next_word();
            if (components != 0 && tuples > bytes_.size() / components)
                return error("more values are announced than the file can hold");
            if (type == "string") {
                if (Status status = read_strings(name, components * tuples); !status) return status;
                continue;
            }
            Result<std::vector<double>> numbers = read_numbers(components * tuples, type);
            if (!numbers) return tl::unexpected(numbers.error());
            keep_region(name, std::move(*numbers));
        }
        return {};
    }

    /// Text arrays: one line each, or in binary files a length and the bytes.
    Status read_strings(const std::string& name, std::size_t count) {
        next_line();
        for (std::size_t i = 0; i < count; ++i) {
            if (at_ >= bytes_.size()) return error("the file ends in the middle of a text array");
            const std::string_view text = binary_ ? next_binary_string() : next_line();
            if (name == "region_names") region_names_[static_cast<std::int64_t>(i)] = percent_decoded(text);
        }
        return {};
    }

    /// The top two bits of the first byte tell how many bytes hold the length: 3: one, 2: two, 1: four, 0: eight.
    std::string_view next_binary_string() {
        const unsigned first = static_cast<unsigned char>(bytes_[at_]);
        const std::size_t width = std::size_t{1} << (3 - (first >> 6U));
        std::uint64_t length = first & 63U;
        for (std::size_t k = 1; k < width && at_ + k < bytes_.size(); ++k)
            length = length << 8U | static_cast<unsigned char>(bytes_[at_ + k]);
        at_ = std::min(at_ + width, bytes_.size());
        const std::string_view text = bytes_.substr(at_, std::min<std::uint64_t>(length, bytes_.size() - at_));
        at_ += text.size();
        return text;
    }

    static std::string percent_decoded(std::string_view text) {
        std::string out;
        for (std::size_t i = 0; i < text.size(); ++i) {
            unsigned code = 0;
            const char* const end = text.data() + std::min(i + 3, text.size());
            const bool coded =
                text[i] == '%' && i + 2 < text.size() && std::from_chars(text.data() + i + 1, end, code, 16).ptr == end;
            out += coded ? static_cast<char>(code) : text[i];
            i += coded ? 2 : 0;
        }
        return out;
    }

    /// "COLOR_SCALARS name n": bytes in binary files, fractions in text.
    Status skip_colors() {
        next_word();
        std::size_t components = 0;
        if (Status status = read_count(components); !status) return status;
        return skip_values(components, std::min(data_count_, bytes_.size()), binary_ ? "unsigned_char" : "float");
    }

    /// "LOOKUP_TABLE name n": n colours.
    Status skip_lookup_table() {
        next_word();
        std::size_t colors = 0;
        if (Status status = read_count(colors); !status) return status;
        return skip_values(4, colors, binary_ ? "unsigned_char" : "float");
    }

    Status skip_texture_coordinates() {
        next_word();
        std::size_t components = 0;
        if (Status status = read_count(components); !status) return status;
        return skip_values(components, std::min(data_count_, bytes_.size()), next_word());
    }

    Status skip_values(std::size_t components, std::size_t count, const std::string& type) {
        if (components != 0 && count > bytes_.size() / components)
            return error("more values are announced than the file can hold");
        const Result<std::vector<double>> numbers = read_numbers(components * count, type);
        return numbers ? Status{} : tl::unexpected(numbers.error());
    }

    Status skip_array(std::size_t components) {
        next_word();
        return skip_values(components, std::min(data_count_, bytes_.size()), next_word());
    }

    void skip_metadata() {
        next_line();
        while (at_ < bytes_.size() && !next_line().empty()) {
        }
    }

    Result<TetMesh> assemble() {
        if (types_.size() != cells_.size() - 1)
            return error(fmt::format("{} cells but {} cell types", cells_.size() - 1, types_.size()));
        TetCollector collector(std::move(points_));
        for (std::size_t c = 0; c < types_.size(); ++c) {
            if (types_[c] != vtk_tetra && types_[c] != vtk_quadratic_tetra) continue;
            const std::span nodes(connectivity_.begin() + static_cast<std::ptrdiff_t>(cells_[c]),
                                  connectivity_.begin() + static_cast<std::ptrdiff_t>(cells_[c + 1]));
            if (nodes.size() != (types_[c] == vtk_tetra ? 4u : 10u))
                return error(fmt::format("cell {} has {} nodes", c, nodes.size()));
            const double region = c < region_values_.size() ? region_values_[c] : 0;
            if (Status status = collector.add(nodes, static_cast<std::int64_t>(region)); !status)
                return error(fmt::format("cell {}: {}", c, status.error().message));
        }
        Result<TetMesh> mesh = collector.finish(region_names_);
        return mesh ? std::move(mesh) : error(mesh.error().message);
    }

    std::string_view bytes_;
    std::string name_;
    std::size_t at_ = 0;
    bool binary_ = false;
    bool data_of_cells_ = false;
    std::size_t data_count_ = 0;
    std::vector<Vec3> points_;
    std::vector<std::size_t> cells_ = {0};  ///< where each cell ends in connectivity_
    std::vector<std::int64_t> connectivity_;
    std::vector<double> types_;
    std::vector<double> region_values_;
    std::map<std::int64_t, std::string> region_names_;
};

}  // namespace

Result<TetMesh> parse_vtk(std::string_view bytes, const std::string& name) {
    return VtkReader(bytes, name).read();
}

}  // namespace pliant::mesh
