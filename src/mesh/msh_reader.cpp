// Gmsh mesh files as text. Format: Gmsh reference manual, "MSH file format" (4.1) and "MSH file format version 2".
#include <array>
#include <map>
#include <unordered_map>

#include "mesh/tet_collector.hpp"
#include "mesh/tet_file.hpp"
#include "mesh/text_scanner.hpp"

namespace pliant::mesh {
namespace {

constexpr std::int64_t gmsh_tetra = 4;
constexpr std::int64_t gmsh_quadratic_tetra = 11;

/// Order of Gmsh's 10-node tet in ours: its last two mid-edge nodes are swapped.
constexpr std::array<std::size_t, 10> gmsh_order = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

class MshReader {
public:
    MshReader(std::string_view text, std::string name) : scan_(text, std::move(name)) {}

    Result<TetMesh> read() {
        for (std::string_view section = scan_.word(); !section.empty(); section = scan_.word()) {
            Status status;
            if (section == "$MeshFormat")
                status = read_format();
            else if (section == "$PhysicalNames")
                status = read_names();
            else if (section == "$Entities")
                status = read_entities();
            else if (section == "$Nodes")
                status = version_ == 2 ? read_nodes_2() : read_nodes_4();
            else if (section == "$Elements")
                status = version_ == 2 ? read_elements_2() : read_elements_4();
            else if (!section.starts_with('$'))
                return scan_.error(fmt::format("\"{}\" is no section of a .msh file", section.substr(0, 40)));
            else
                skip_section();
            if (!status) return tl::unexpected(status.error());
        }
        return assemble();
    }

private:
    struct Tet {
        std::array<std::int64_t, 10> nodes;
        std::size_t width;
        std::int64_t physical, elementary;
    };

    /// Reads `Count` whole numbers.
    template <std::size_t Count>
    Result<std::array<std::int64_t, Count>> integers() {
        std::array<std::int64_t, Count> values{};
        for (std::int64_t& value : values) {
            const Result<std::int64_t> one = scan_.integer();
            if (!one) return tl::unexpected(one.error());
            value = *one;
        }
        return values;
    }

    void skip_section() {
        while (!scan_.at_end() && !scan_.rest_of_line().starts_with("$End")) {
        }
    }

    Status expect_end() {
        const std::string_view end = scan_.word();
        if (end.starts_with("$End")) return {};
        return scan_.error(fmt::format("the end of the section is needed instead of \"{}\"", end.substr(0, 40)));
    }

    Status read_format() {
        const std::string version(scan_.word());
        if (version == "2" || version == "2.1" || version == "2.2")
            version_ = 2;
        else if (version == "4.1")
            version_ = 4;
        else
            return scan_.error(fmt::format("version \"{}\" is not read; save as 4.1 or 2.2", version.substr(0, 40)));
        if (scan_.word() != "0") return scan_.error("binary .msh files are not read; save as text (Mesh.Binary = 0)");
        skip_section();
        return {};
    }

    Status read_names() {
        const Result<std::size_t> count = scan_.count(5);
        if (!count) return tl::unexpected(count.error());
        for (std::size_t i = 0; i < *count; ++i) {
            const auto ids = integers<2>();
            if (!ids) return tl::unexpected(ids.error());
            const std::string_view quoted = scan_.rest_of_line();
            if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"')
                return scan_.error("a name in quotes is needed");
            if ((*ids)[0] == 3) names_[(*ids)[1]] = std::string(quoted.substr(1, quoted.size() - 2));
        }
        return expect_end();
    }

    /// Version 4: which physical group a volume belongs to.
    Status read_entities() {
        const auto counts = integers<4>();
        if (!counts) return tl::unexpected(counts.error());
        scan_.rest_of_line();
        for (std::size_t dimension = 0; dimension < 4; ++dimension) {
            for (std::int64_t i = 0; i < (*counts)[dimension]; ++i) {
                if (scan_.at_end()) return scan_.error("the file ends in the middle of $Entities");
                if (dimension == 3) {
                    if (Status status = read_volume(); !status) return status;
                }
                scan_.rest_of_line();
            }
        }
        return expect_end();
    }

    Status read_volume() {
        const Result<std::int64_t> tag = scan_.integer();
        if (!tag) return tl::unexpected(tag.error());
        for (int i = 0; i < 6; ++i) {  // its box
            if (const Result<double> bound = scan_.number(); !bound) return tl::unexpected(bound.error());
        }
        const Result<std::int64_t> groups = scan_.integer();
        if (!groups) return tl::unexpected(groups.error());
        if (*groups < 1) return {};
        const Result<std::int64_t> first = scan_.integer();
        if (!first) return tl::unexpected(first.error());
        physical_of_volume_[*tag] = *first;
        return {};
    }

    Status read_point(std::int64_t tag) {
        Vec3 p;
        for (std::size_t k = 0; k < 3; ++k) {
            const Result<double> one = scan_.number();
            if (!one) return tl::unexpected(one.error());
            p[k] = *one;
        }
        scan_.rest_of_line();  // parametric coordinates may follow
        if (!index_.try_emplace(tag, static_cast<std::int64_t>(points_.size())).second)
            return scan_.error(fmt::format("node {} comes twice", tag));
        points_.push_back(p);
        return {};
    }

    Status read_nodes_2() {
        const Result<std::size_t> count = scan_.count(8);
        if (!count) return tl::unexpected(count.error());
        for (std::size_t i = 0; i < *count; ++i) {
            const Result<std::int64_t> tag = scan_.integer();
            if (!tag) return tl::unexpected(tag.error());
            if (Status status = read_point(*tag); !status) return status;
        }
        return expect_end();
    }

    Status read_nodes_4() {
        const auto head = integers<4>();
        if (!head) return tl::unexpected(head.error());
        for (std::int64_t block = 0; block < (*head)[0]; ++block) {
            const auto entity = integers<3>();
            if (!entity) return tl::unexpected(entity.error());
            const Result<std::size_t> count = scan_.count(8);
            if (!count) return tl::unexpected(count.error());
            std::vector<std::int64_t> tags;
            for (std::size_t i = 0; i < *count; ++i) {
                const Result<std::int64_t> tag = scan_.integer();
                if (!tag) return tl::unexpected(tag.error());
                tags.push_back(*tag);
            }
            for (const std::int64_t tag : tags) {
                if (Status status = read_point(tag); !status) return status;
            }
        }
        return expect_end();
    }

    Status read_tet_nodes(std::int64_t type, std::int64_t physical, std::int64_t elementary) {
        Tet tet{{}, type == gmsh_tetra ? 4u : 10u, physical, elementary};
        for (std::size_t a = 0; a < tet.width; ++a) {
            const Result<std::int64_t> node = scan_.integer();
            if (!node) return tl::unexpected(node.error());
            const auto found = index_.find(*node);
            if (found == index_.end())
                return scan_.error(fmt::format("a tetrahedron names node {}, there is none", *node));
            tet.nodes[gmsh_order[a]] = found->second;
        }
        tets_.push_back(tet);
        return {};
    }

    Status read_elements_2() {
        const Result<std::size_t> count = scan_.count(6);
        if (!count) return tl::unexpected(count.error());
        for (std::size_t i = 0; i < *count; ++i) {
            const auto head = integers<3>();  // number, type, how many tags
            if (!head) return tl::unexpected(head.error());
            const auto& [number, type, tags] = *head;
            if (type == gmsh_tetra || type == gmsh_quadratic_tetra) {
                if (tags < 2) return scan_.error(fmt::format("element {} has {} tags, two are needed", number, tags));
                const auto first = integers<2>();
                if (!first) return tl::unexpected(first.error());
                for (std::int64_t t = 2; t < tags; ++t) {
                    if (const Result<std::int64_t> more = scan_.integer(); !more) return tl::unexpected(more.error());
                }
                if (Status status = read_tet_nodes(type, (*first)[0], (*first)[1]); !status) return status;
            }
            scan_.rest_of_line();
        }
        return expect_end();
    }

    Status read_elements_4() {
        const auto head = integers<4>();
        if (!head) return tl::unexpected(head.error());
        for (std::int64_t block = 0; block < (*head)[0]; ++block) {
            const auto entity = integers<3>();  // dimension, tag, type
            if (!entity) return tl::unexpected(entity.error());
            const auto& [dimension, tag, type] = *entity;
            const Result<std::size_t> count = scan_.count(4);
            if (!count) return tl::unexpected(count.error());
            scan_.rest_of_line();
            const auto group = physical_of_volume_.find(tag);
            const std::int64_t physical = group == physical_of_volume_.end() ? 0 : group->second;
            for (std::size_t i = 0; i < *count; ++i) {
                if (type == gmsh_tetra || type == gmsh_quadratic_tetra) {
                    if (const Result<std::int64_t> number = scan_.integer(); !number)
                        return tl::unexpected(number.error());
                    if (Status status = read_tet_nodes(type, physical, tag); !status) return status;
                }
                scan_.rest_of_line();
            }
        }
        return expect_end();
    }

    Result<TetMesh> assemble() {
        bool grouped = false;
        for (const Tet& tet : tets_) grouped = grouped || tet.physical != 0;
        TetCollector collector(std::move(points_));
        for (const Tet& tet : tets_) {
            Status status =
                collector.add(std::span(tet.nodes).first(tet.width), grouped ? tet.physical : tet.elementary);
            if (!status) return scan_.error(status.error().message);
        }
        Result<TetMesh> mesh = collector.finish(grouped ? names_ : std::map<std::int64_t, std::string>{});
        if (!mesh) return scan_.error(mesh.error().message);
        return mesh;
    }

    TextScanner scan_;
    int version_ = 4;
    std::map<std::int64_t, std::string> names_;
    std::map<std::int64_t, std::int64_t> physical_of_volume_;
    std::unordered_map<std::int64_t, std::int64_t> index_;  ///< node number to position in points_
    std::vector<Vec3> points_;
    std::vector<Tet> tets_;
};

}  // namespace

Result<TetMesh> parse_msh(std::string_view bytes, const std::string& name) {
    return MshReader(bytes, name).read();
}

}  // namespace pliant::mesh
