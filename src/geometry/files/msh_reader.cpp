// Gmsh mesh files, 2.2 and 4.1, text and binary of either byte order.
// Format: Gmsh reference manual, "MSH file format" (4.1) and "MSH file format version 2 (Legacy)".
#include <array>
#include <map>
#include <optional>

#include "geometry/files/mid_edge_order.hpp"
#include "geometry/files/msh_input.hpp"
#include "geometry/files/numbered_points.hpp"
#include "geometry/files/tet_collector.hpp"
#include "geometry/files/tet_file.hpp"

namespace pliant::mesh {
namespace {

constexpr std::int64_t gmsh_tetra = 4;
constexpr std::int64_t gmsh_quadratic_tetra = 11;

bool is_tet(std::int64_t type) {
    return type == gmsh_tetra || type == gmsh_quadratic_tetra;
}

/// Nodes of an element, by Gmsh's number of its type; 0: unknown.
std::size_t nodes_of(std::int64_t type) {
    static constexpr std::array<std::size_t, 32> counts = {0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                                           8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};
    if (type == 92) return 64;
    if (type == 93) return 125;
    return type > 0 && type < 32 ? counts[static_cast<std::size_t>(type)] : 0;
}

class MshReader {
public:
    MshReader(std::string_view bytes, std::string name) : in_(bytes, std::move(name)) {}

    Result<TetMesh> read() {
        for (std::string section = in_.section(); !section.empty(); section = in_.section()) {
            if (Status status = read_section(section); !status) return tl::unexpected(status.error());
        }
        return assemble();
    }

private:
    struct Tet {
        std::array<std::int64_t, 10> nodes;
        std::size_t width;
        std::int64_t physical, elementary;
    };

    Status read_section(const std::string& section) {
        if (section == "$MeshFormat") return read_format();
        if (section == "$PhysicalNames") return read_names();
        if (section == "$Entities") return version_ == 4 ? read_entities() : in_.skip_section(section);
        if (section == "$Nodes") return version_ == 2 ? read_nodes_2() : read_blocks(&MshReader::read_node_block);
        if (section == "$Elements")
            return version_ == 2 ? read_elements_2() : read_blocks(&MshReader::read_element_block);
        if (section.starts_with('$')) return in_.skip_section(section);
        return in_.error(fmt::format("\"{}\" is not a section of a .msh file", section.substr(0, 40)));
    }

    Status read_format() {
        const std::string version = in_.word();
        if (version == "2" || version == "2.1" || version == "2.2")
            version_ = 2;
        else if (version == "4.1")
            version_ = 4;
        else
            return in_.error(fmt::format("version \"{}\" is not read; save as 4.1 or 2.2", version.substr(0, 40)));
        const std::string kind = in_.word();
        const std::string size = in_.word();
        if (kind == "1") {
            if (size != "8" && size != "4")
                return in_.error(fmt::format("a data size of \"{}\" is not read; 8 is", size.substr(0, 40)));
            if (Status status = in_.begin_binary(size == "8"); !status) return status;
        } else if (kind != "0") {
            return in_.error("the file type must be 0 (text) or 1 (binary)");
        }
        return in_.skip_section("$MeshFormat");
    }

    Status read_names() {
        const Result<std::size_t> count = in_.text_count(5);
        if (!count) return tl::unexpected(count.error());
        for (std::size_t i = 0; i < *count; ++i) {
            const Result<std::int64_t> dimension = in_.text_integer();
            if (!dimension) return tl::unexpected(dimension.error());
            const Result<std::int64_t> tag = in_.text_integer();
            if (!tag) return tl::unexpected(tag.error());
            const std::string_view quoted = in_.rest_of_line();
            if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"')
                return in_.error("a name in quotes is needed");
            if (*dimension == 3) names_[*tag] = std::string(quoted.substr(1, quoted.size() - 2));
        }
        return in_.expect_end();
    }

    /// Version 4: the physical group of each volume.
    Status read_entities() {
        in_.skip_line_end();
        std::array<std::size_t, 4> counts{};
        for (std::size_t& count : counts) {
            const Result<std::size_t> one = in_.count(8);
            if (!one) return tl::unexpected(one.error());
            count = *one;
        }
        for (std::size_t dimension = 0; dimension < 4; ++dimension) {
            for (std::size_t i = 0; i < counts[dimension]; ++i) {
                if (Status status = read_entity(dimension); !status) return status;
            }
        }
        return in_.expect_end();
    }

    /// Tag, point or box, physical groups and, except for points, the bounding entities.
    Status read_entity(std::size_t dimension) {
        const Result<std::int64_t> tag = in_.integer();
        if (!tag) return tl::unexpected(tag.error());
        for (int i = 0; i < (dimension == 0 ? 3 : 6); ++i) {
            if (const Result<double> bound = in_.number(); !bound) return tl::unexpected(bound.error());
        }
        const Result<std::size_t> groups = in_.count(2);
        if (!groups) return tl::unexpected(groups.error());
        for (std::size_t g = 0; g < *groups; ++g) {
            const Result<std::int64_t> group = in_.integer();
            if (!group) return tl::unexpected(group.error());
            if (dimension == 3 && g == 0) physical_of_volume_[*tag] = *group;
        }
        if (dimension == 0) return {};
        const Result<std::size_t> bounds = in_.count(2);
        if (!bounds) return tl::unexpected(bounds.error());
        for (std::size_t b = 0; b < *bounds; ++b) {
            if (const Result<std::int64_t> bound = in_.integer(); !bound) return tl::unexpected(bound.error());
        }
        return {};
    }

    Status read_point(std::int64_t tag, std::size_t parameters) {
        Vec3 p;
        for (std::size_t k = 0; k < 3; ++k) {
            const Result<double> one = in_.number();
            if (!one) return tl::unexpected(one.error());
            p[k] = *one;
        }
        for (std::size_t k = 0; k < parameters; ++k) {
            if (const Result<double> one = in_.number(); !one) return tl::unexpected(one.error());
        }
        if (!points_.add(tag, p)) return in_.error(fmt::format("node {} comes twice", tag));
        return {};
    }

    Status read_nodes_2() {
        const Result<std::size_t> count = in_.text_count(8);
        if (!count) return tl::unexpected(count.error());
        in_.skip_line_end();
        points_.reserve(*count);
        for (std::size_t i = 0; i < *count; ++i) {
            const Result<std::int64_t> tag = in_.integer();
            if (!tag) return tl::unexpected(tag.error());
            if (Status status = read_point(*tag, 0); !status) return status;
        }
        return in_.expect_end();
    }

    /// Sections of version 4: a header whose first number is the count of the following blocks.
    Status read_blocks(Status (MshReader::*read_block)()) {
        in_.skip_line_end();
        const auto head = in_.sizes<4>();
        if (!head) return tl::unexpected(head.error());
        for (std::uint64_t block = 0; block < (*head)[0]; ++block) {
            if (Status status = (this->*read_block)(); !status) return status;
        }
        return in_.expect_end();
    }

    Status read_node_block() {
        const auto entity = in_.integers<3>();  // dimension, tag, whether parameters follow
        if (!entity) return tl::unexpected(entity.error());
        const std::int64_t dimension = (*entity)[0];
        const bool parametric = (*entity)[2] != 0 && dimension > 0 && dimension <= 3;
        const Result<std::size_t> count = in_.count(8);
        if (!count) return tl::unexpected(count.error());
        std::vector<std::int64_t> tags;
        tags.reserve(*count);
        for (std::size_t i = 0; i < *count; ++i) {
            const Result<std::int64_t> tag = in_.size();
            if (!tag) return tl::unexpected(tag.error());
            tags.push_back(*tag);
        }
        for (const std::int64_t tag : tags) {
            const std::size_t parameters = parametric ? static_cast<std::size_t>(dimension) : 0;
            if (Status status = read_point(tag, parameters); !status) return status;
        }
        return {};
    }

    /// `next` reads one node number: 4 bytes in version 2, 8 in version 4.
    template <class Next>
    Status read_tet(std::int64_t type, std::int64_t physical, std::int64_t elementary, const Next& next) {
        Tet tet{{}, nodes_of(type), physical, elementary};
        for (std::size_t a = 0; a < tet.width; ++a) {
            const Result<std::int64_t> node = next();
            if (!node) return tl::unexpected(node.error());
            const std::int64_t place = points_.find(*node);
            if (place < 0)
                return in_.error(fmt::format("a tetrahedron refers to node {}, which does not exist", *node));
            tet.nodes[gmsh_order[a]] = place;
        }
        tets_.push_back(tet);
        return {};
    }

    Status read_elements_2() {
        const Result<std::size_t> count = in_.text_count(6);
        if (!count) return tl::unexpected(count.error());
        in_.skip_line_end();
        if (!in_.binary()) {
            for (std::size_t i = 0; i < *count; ++i) {
                const auto head = in_.integers<3>();  // number, type, number of tags
                if (!head) return tl::unexpected(head.error());
                if (Status status = read_element_2((*head)[1], (*head)[2], (*head)[0]); !status) return status;
            }
            return in_.expect_end();
        }
        for (std::size_t i = 0; i < *count;) {
            const auto head = in_.integers<3>();  // type, number of elements that follow, number of tags
            if (!head) return tl::unexpected(head.error());
            if ((*head)[1] < 1) return in_.error("a group of elements is empty");
            for (std::int64_t e = 0; e < (*head)[1]; ++e, ++i) {
                const Result<std::int64_t> number = in_.integer();
                if (!number) return tl::unexpected(number.error());
                if (Status status = read_element_2((*head)[0], (*head)[2], *number); !status) return status;
            }
        }
        return in_.expect_end();
    }

    /// Tags (physical group, elementary entity, others), then nodes.
    Status read_element_2(std::int64_t type, std::int64_t tag_count, std::int64_t number) {
        if (!in_.binary() && !is_tet(type)) {
            in_.rest_of_line();
            return {};
        }
        if (is_tet(type) && tag_count < 2)
            return in_.error(fmt::format("element {} has {} tags, two are needed", number, tag_count));
        std::array<std::int64_t, 2> tags{};
        for (std::int64_t t = 0; t < tag_count; ++t) {
            const Result<std::int64_t> tag = in_.integer();
            if (!tag) return tl::unexpected(tag.error());
            if (t < 2) tags[static_cast<std::size_t>(t)] = *tag;
        }
        if (!is_tet(type)) return skip_nodes(type, 1, 4);
        Status status = read_tet(type, tags[0], tags[1], [&] { return in_.integer(); });
        if (status && !in_.binary()) in_.rest_of_line();
        return status;
    }

    /// Skips binary elements that are not needed: `rows` rows of nodes (plus a number in version 4) of `width` bytes
    /// each.
    Status skip_nodes(std::int64_t type, std::size_t per_row, std::size_t width, std::size_t rows = 1) {
        const std::size_t nodes = nodes_of(type);
        if (nodes == 0) return in_.error(fmt::format("elements of type {} are not known", type));
        return in_.skip_bytes(rows, (nodes + per_row - 1) * width);
    }

    Status read_element_block() {
        const auto entity = in_.integers<3>();  // dimension, tag, type
        if (!entity) return tl::unexpected(entity.error());
        const auto& [dimension, tag, type] = *entity;
        const Result<std::size_t> count = in_.count(4);
        if (!count) return tl::unexpected(count.error());
        if (in_.binary() && !is_tet(type)) return skip_nodes(type, 2, in_.size_width(), *count);
        if (!in_.binary()) in_.rest_of_line();
        const auto group = physical_of_volume_.find(tag);
        const std::int64_t physical = group == physical_of_volume_.end() ? 0 : group->second;
        for (std::size_t i = 0; i < *count; ++i) {
            if (!is_tet(type)) {
                in_.rest_of_line();
                continue;
            }
            if (const Result<std::int64_t> number = in_.size(); !number) return tl::unexpected(number.error());
            Status status = read_tet(type, physical, tag, [&] { return in_.size(); });
            if (!status) return status;
            if (!in_.binary()) in_.rest_of_line();
        }
        return {};
    }

    Result<TetMesh> assemble() {
        bool grouped = false;
        for (const Tet& tet : tets_) grouped = grouped || tet.physical != 0;
        TetCollector collector(points_.take());
        for (const Tet& tet : tets_) {
            Status status =
                collector.add(std::span(tet.nodes).first(tet.width), grouped ? tet.physical : tet.elementary);
            if (!status) return in_.error(status.error().message);
        }
        Result<TetMesh> mesh = collector.finish(grouped ? names_ : std::map<std::int64_t, std::string>{});
        if (!mesh) return in_.error(mesh.error().message);
        return mesh;
    }

    MshInput in_;
    int version_ = 4;
    std::map<std::int64_t, std::string> names_;
    std::map<std::int64_t, std::int64_t> physical_of_volume_;
    NumberedPoints points_;
    std::vector<Tet> tets_;
};

}  // namespace

Result<TetMesh> parse_msh(std::string_view bytes, const std::string& name) {
    return MshReader(bytes, name).read();
}

}  // namespace pliant::mesh
