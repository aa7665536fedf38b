// Gmsh mesh files, 4.1. Format: Gmsh reference manual, "MSH file format".
#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "base/core/boxes.hpp"
#include "geometry/files/mid_edge_order.hpp"
#include "geometry/files/tet_writer.hpp"

namespace pliant::mesh {
namespace {

class MshWriter {
public:
    MshWriter(const TetMesh& mesh, Encoding encoding) : mesh_(mesh), text_(encoding == Encoding::text) {
        static_assert(std::endian::native == std::endian::little, "the 1 in the head tells the byte order");
    }

    std::string write() {
        const auto width = static_cast<std::size_t>(mesh_.nodes_per_tet());
        out_.reserve(32 * mesh_.points.size() + 8 * (width + 1) * mesh_.tet_count() + 4096);
        add_format();
        add_names();
        add_entities();
        add_nodes();
        add_elements();
        return std::move(out_);
    }

private:
    void integer(std::int64_t value) {
        if (text_)
            word(value);
        else
            bytes(static_cast<std::int32_t>(value));
    }
    void size(std::size_t value) {
        if (text_)
            word(value);
        else
            bytes(static_cast<std::uint64_t>(value));
    }
    void real(double value) {
        if (text_)
            word(value);
        else
            bytes(value);
    }
    void end_of_row() {
        if (text_) out_.back() = '\n';
    }
    void end_section(std::string_view name) {
        if (!text_) out_ += '\n';
        out_ += fmt::format("$End{}\n", name);
    }
    template <class Value>
    void word(Value value) {
        fmt::format_to(std::back_inserter(out_), "{} ", value);
    }
    template <class Value>
    void bytes(Value value) {
        char raw[sizeof(Value)];
        std::memcpy(raw, &value, sizeof(Value));
        out_.append(raw, sizeof(Value));
    }

    void add_format() {
        out_ += fmt::format("$MeshFormat\n4.1 {} 8\n", text_ ? 0 : 1);
        if (!text_) bytes(std::int32_t{1});
        if (!text_) out_ += '\n';
        out_ += "$EndMeshFormat\n";
    }

    void add_names() {
        out_ += fmt::format("$PhysicalNames\n{}\n", mesh_.region_names.size());
        for (std::size_t r = 0; r < mesh_.region_names.size(); ++r) {
            std::string name = mesh_.region_names[r];
            for (char& c : name) c = c == '"' || c == '\n' ? '\'' : c;
            out_ += fmt::format("3 {} \"{}\"\n", r + 1, name);
        }
        out_ += "$EndPhysicalNames\n";
    }

    void add_entities() {
        const Box3 box = bounds_of(mesh_.points);
        out_ += "$Entities\n";
        for (int dimension = 0; dimension < 3; ++dimension) size(0);
        size(mesh_.region_names.size());
        end_of_row();
        for (std::size_t r = 0; r < mesh_.region_names.size(); ++r) {
            integer(static_cast<std::int64_t>(r) + 1);
            for (const Vec3& corner : {box.low, box.high}) {
                for (std::size_t k = 0; k < 3; ++k) real(corner[k]);
            }
            size(1);
            integer(static_cast<std::int64_t>(r) + 1);
            size(0);
            end_of_row();
        }
        end_section("Entities");
    }

    /// All nodes are assigned to the first volume, because regions share nodes.
    void add_nodes() {
        const std::size_t count = mesh_.points.size();
        out_ += "$Nodes\n";
        for (const std::size_t value : {std::size_t{1}, count, std::size_t{1}, count}) size(value);
        end_of_row();
        for (const int value : {3, 1, 0}) integer(value);
        size(count);
        end_of_row();
        for (std::size_t i = 0; i < count; ++i) {
            size(i + 1);
            end_of_row();
        }
        for (const Vec3& p : mesh_.points) {
            for (std::size_t k = 0; k < 3; ++k) real(p[k]);
            end_of_row();
        }
        end_section("Nodes");
    }

    void add_elements() {
        std::vector<std::size_t> tets_of(mesh_.region_names.size());
        for (const int region : mesh_.region) ++tets_of[static_cast<std::size_t>(region)];
        std::size_t blocks = 0;
        for (const std::size_t tets : tets_of) blocks += tets > 0 ? 1 : 0;
        out_ += "$Elements\n";
        for (const std::size_t value : {blocks, mesh_.tet_count(), std::size_t{1}, mesh_.tet_count()}) size(value);
        end_of_row();
        for (std::size_t r = 0; r < tets_of.size(); ++r) {
            if (tets_of[r] > 0) add_block(static_cast<int>(r), tets_of[r]);
        }
        end_section("Elements");
    }

    void add_block(int region, std::size_t tets) {
        for (const int value : {3, region + 1, mesh_.order == 2 ? 11 : 4}) integer(value);
        size(tets);
        end_of_row();
        for (std::size_t t = 0; t < mesh_.tet_count(); ++t) {
            if (mesh_.region[t] != region) continue;
            size(++element_);
            const auto nodes = mesh_.tet(t);
            for (std::size_t a = 0; a < nodes.size(); ++a) size(static_cast<std::size_t>(nodes[gmsh_order[a]]) + 1);
            end_of_row();
        }
    }

    const TetMesh& mesh_;
    bool text_;
    std::string out_;
    std::size_t element_ = 0;
};

}  // namespace

std::string msh_bytes(const TetMesh& mesh, Encoding encoding) {
    return MshWriter(mesh, encoding).write();
}

}  // namespace pliant::mesh
