// Legacy VTK files: text lines, and arrays as text or big-endian bytes.
// Format: VTK User's Guide, "Simple legacy formats"; version 5 has separate arrays of offsets and connectivity.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "geometry/files/tet_collector.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/tet_writer.hpp"
#include "geometry/files/vtk_cells.hpp"
#include "geometry/files/vtk_stream.hpp"

namespace pliant::mesh {
namespace {

/// Reads the sections of a legacy VTK file in order.
class VtkReader {
public:
    VtkReader(std::string_view bytes, std::string name) : file_(bytes, std::move(name)) {}

    Result<TetMesh> read() {
        if (Status status = read_header(); !status) return tl::unexpected(status.error());
        for (std::string word = file_.next_word(); !word.empty(); word = file_.next_word()) {
            Status status;
            if (word == "POINTS")
                status = read_points();
            else if (word == "CELLS")
                status = read_cells();
            else if (word == "CELL_TYPES")
                status = read_types();
            else if (word == "CELL_DATA")
                data_of_cells_ = true, status = file_.read_count(data_count_);
            else if (word == "POINT_DATA")
                data_of_cells_ = false, status = file_.read_count(data_count_);
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
                return file_.error("\"" + word.substr(0, 40) + "\" is not understood");
            if (!status) return tl::unexpected(status.error());
        }
        return assemble();
    }

private:
    Status read_header() {
        if (!file_.next_line().starts_with("# vtk DataFile Version"))
            return input_error("{}: is not a legacy VTK file", file_.name());
        read_title(file_.next_line());
        std::string_view encoding = file_.next_line();
        while (!encoding.empty() && VtkStream::is_blank(encoding.back())) encoding.remove_suffix(1);
        if (encoding == "BINARY")
            file_.set_binary();
        else if (encoding != "ASCII")
            return file_.error("the third line must be ASCII or BINARY");
        if (file_.next_word() != "DATASET" || file_.next_word() != "UNSTRUCTURED_GRID")
            return file_.error("only DATASET UNSTRUCTURED_GRID holds tetrahedra");
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

    Status read_points() {
        std::size_t count = 0;
        if (Status status = file_.read_count(count); !status) return status;
        const std::string type = file_.next_word();
        if (count > file_.size()) return file_.error("more points are announced than the file can hold");
        const Result<std::vector<double>> numbers = file_.read_numbers(3 * count, type);
        if (!numbers) return tl::unexpected(numbers.error());
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 p{(*numbers)[3 * i], (*numbers)[3 * i + 1], (*numbers)[3 * i + 2]};
            if (!is_finite(p)) return file_.error(fmt::format("point {} is not finite", i));
            points_.push_back(p);
        }
        return {};
    }

    /// Up to version 4: "CELLS n size", each cell its node count and nodes. From 5: separate offsets and connectivity.
    Status read_cells() {
        std::size_t count = 0;
        std::size_t size = 0;
        if (Status status = file_.read_count(count); !status) return status;
        if (Status status = file_.read_count(size); !status) return status;
        const std::size_t mark = file_.mark();
        if (file_.next_word() == "OFFSETS") return read_offset_cells(count, size);
        file_.go_back(mark);
        const Result<std::vector<double>> list = file_.read_numbers(size, "int");
        if (!list) return tl::unexpected(list.error());
        std::size_t at = 0;
        for (std::size_t c = 0; c < count; ++c) {
            const double nodes = at < size ? (*list)[at] : -1;
            if (!(nodes >= 0 && nodes <= static_cast<double>(size - at - 1)))
                return file_.error(fmt::format("cell {} runs past the end of the list", c));
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
                return file_.error(fmt::format("cell {} names point {}", cells_.size() - 1, list[i]));
            connectivity_.push_back(static_cast<std::int64_t>(list[i]));
        }
        cells_.push_back(connectivity_.size());
        return {};
    }

    Status read_offset_cells(std::size_t offsets, std::size_t size) {
        const std::string offset_type = file_.next_word();
        const Result<std::vector<double>> starts = file_.read_numbers(offsets, offset_type);
        if (!starts) return tl::unexpected(starts.error());
        if (file_.next_word() != "CONNECTIVITY") return file_.error("CONNECTIVITY is needed after OFFSETS");
        const std::string type = file_.next_word();
        const Result<std::vector<double>> list = file_.read_numbers(size, type);
        if (!list) return tl::unexpected(list.error());
        for (std::size_t c = 0; c + 1 < offsets; ++c) {
            const double begin = (*starts)[c];
            const double end = (*starts)[c + 1];
            if (!(begin >= 0 && end >= begin && end <= static_cast<double>(size)))
                return file_.error(fmt::format("cell {} runs past the end of the list", c));
            Status status = add_cell(*list, static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
            if (!status) return status;
        }
        return {};
    }

    Status read_types() {
        std::size_t count = 0;
        if (Status status = file_.read_count(count); !status) return status;
        const Result<std::vector<double>> numbers = file_.read_numbers(count, "int");
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
        const std::string name = file_.next_word();
        const std::string type = file_.next_word();
        std::size_t components = 1;
        const std::string_view rest = file_.next_line();
        if (rest.find_first_of("1234") != std::string_view::npos)
            components = static_cast<std::size_t>(rest[rest.find_first_of("1234")] - '0');
        const std::size_t mark = file_.mark();
        if (file_.next_word() == "LOOKUP_TABLE")
            file_.next_line();
        else
            file_.go_back(mark);
        if (file_.binary()) file_.before_line_end();
        Result<std::vector<double>> numbers =
            file_.read_numbers(components * std::min(data_count_, file_.size()), type);
        if (!numbers) return tl::unexpected(numbers.error());
        keep_region(name, std::move(*numbers));
        return {};
    }

    Status read_field() {
        file_.next_word();
        std::size_t arrays = 0;
        if (Status status = file_.read_count(arrays); !status) return status;
        for (std::size_t a = 0; a < arrays; ++a) {
            const std::string name = file_.next_word();
            if (name.empty()) return file_.error("the file ends in the middle of a FIELD");
            std::size_t components = 0;
            std::size_t tuples = 0;
            if (Status status = file_.read_count(components); !status) return status;
            if (Status status = file_.read_count(tuples); !status) return status;
            const std::string type = file_.next_word();
            if (components != 0 && tuples > file_.size() / components)
                return file_.error("more values are announced than the file can hold");
            if (type == "string") {
                if (Status status = read_strings(name, components * tuples); !status) return status;
                continue;
            }
            Result<std::vector<double>> numbers = file_.read_numbers(components * tuples, type);
            if (!numbers) return tl::unexpected(numbers.error());
            keep_region(name, std::move(*numbers));
        }
        return {};
    }

    /// String arrays: one line each or, in binary files, a length and the bytes.
    Status read_strings(const std::string& name, std::size_t count) {
        file_.next_line();
        for (std::size_t i = 0; i < count; ++i) {
            if (file_.at_end()) return file_.error("the file ends in the middle of a text array");
            const std::string_view text = file_.next_text();
            if (name == "region_names") region_names_[static_cast<std::int64_t>(i)] = percent_decoded(text);
        }
        return {};
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
        file_.next_word();
        std::size_t components = 0;
        if (Status status = file_.read_count(components); !status) return status;
        return skip_values(components, std::min(data_count_, file_.size()), file_.binary() ? "unsigned_char" : "float");
    }

    /// "LOOKUP_TABLE name n": n colours.
    Status skip_lookup_table() {
        file_.next_word();
        std::size_t colors = 0;
        if (Status status = file_.read_count(colors); !status) return status;
        return skip_values(4, colors, file_.binary() ? "unsigned_char" : "float");
    }

    Status skip_texture_coordinates() {
        file_.next_word();
        std::size_t components = 0;
        if (Status status = file_.read_count(components); !status) return status;
        return skip_values(components, std::min(data_count_, file_.size()), file_.next_word());
    }

    Status skip_values(std::size_t components, std::size_t count, const std::string& type) {
        if (components != 0 && count > file_.size() / components)
            return file_.error("more values are announced than the file can hold");
        const Result<std::vector<double>> numbers = file_.read_numbers(components * count, type);
        return numbers ? Status{} : tl::unexpected(numbers.error());
    }

    Status skip_array(std::size_t components) {
        file_.next_word();
        return skip_values(components, std::min(data_count_, file_.size()), file_.next_word());
    }

    void skip_metadata() {
        file_.next_line();
        while (!file_.at_end() && !file_.next_line().empty()) {
        }
    }

    Result<TetMesh> assemble() {
        if (types_.size() != cells_.size() - 1)
            return file_.error(fmt::format("{} cells but {} cell types", cells_.size() - 1, types_.size()));
        TetCollector collector(std::move(points_));
        for (std::size_t c = 0; c < types_.size(); ++c) {
            if (types_[c] != vtk_tetra && types_[c] != vtk_quadratic_tetra) continue;
            const std::span nodes(connectivity_.begin() + static_cast<std::ptrdiff_t>(cells_[c]),
                                  connectivity_.begin() + static_cast<std::ptrdiff_t>(cells_[c + 1]));
            if (nodes.size() != (types_[c] == vtk_tetra ? 4u : 10u))
                return file_.error(fmt::format("cell {} has {} nodes", c, nodes.size()));
            const double region = c < region_values_.size() ? region_values_[c] : 0;
            if (Status status = collector.add(nodes, static_cast<std::int64_t>(region)); !status)
                return file_.error(fmt::format("cell {}: {}", c, status.error().message));
        }
        Result<TetMesh> mesh = collector.finish(region_names_);
        return mesh ? std::move(mesh) : file_.error(mesh.error().message);
    }

    VtkStream file_;
    bool data_of_cells_ = false;
    std::size_t data_count_ = 0;
    std::vector<Vec3> points_;
    std::vector<std::size_t> cells_ = {0};  ///< end of each cell in connectivity_
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
