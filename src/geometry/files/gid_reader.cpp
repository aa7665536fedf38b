// GiD meshes as text. Format: GiD reference manual, "Mesh format": one or several blocks
//
//     MESH "name" dimension 3 ElemType Tetrahedra Nnode 4
//     Coordinates / number x y z ... / end coordinates
//     Elements / number n1 n2 n3 n4 [material] ... / end elements
//
// Coordinates of all blocks form one list. The region of an element is its material or, without one, its block.
#include <algorithm>

#include "base/core/letters.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/text_tets.hpp"

namespace pliant::mesh {
namespace {

class GidReader {
public:
    GidReader(std::string_view text, std::string name) : scan_(text, name), name_(std::move(name)) {}

    Result<TetMesh> read() {
        for (std::string_view word = scan_.word(); !word.empty(); word = scan_.word()) {
            if (Status status = read_part(lower_case(word)); !status) return tl::unexpected(status.error());
        }
        return finish(std::move(found_), name_);
    }

private:
    struct Block {
        bool tets = false;
        std::size_t width = 0;
        std::int64_t number = 0;
        std::string name;
    };

    Status read_part(const std::string& keyword) {
        if (keyword.starts_with('#')) {
            scan_.rest_of_line();
            return {};
        }
        if (keyword == "mesh") return read_head(scan_.rest_of_line());
        if (keyword == "coordinates") return read_coordinates();
        if (keyword == "elements") return read_elements();
        if (keyword == "unit") {  // written by newer programs: Unit "mm"
            scan_.rest_of_line();
            return {};
        }
        return scan_.error(
            fmt::format("\"{}\" is neither MESH, Coordinates nor Elements", std::string_view(keyword).substr(0, 40)));
    }

    Status read_head(std::string_view line) {
        block_ = Block{false, 0, block_.number + 1, ""};
        if (const std::size_t quote = line.find('"'); quote != std::string_view::npos) {
            const std::size_t end = std::min(line.find('"', quote + 1), line.size());
            block_.name = std::string(line.substr(quote + 1, end - quote - 1));
            line = line.substr(std::min(end + 1, line.size()));
        }
        TextScanner words(line, name_);
        for (std::string word = lower_case(words.word()); !word.empty(); word = lower_case(words.word())) {
            if (word == "elemtype") block_.tets = lower_case(words.word()).starts_with("tetra");
            if (word != "nnode" && word != "dimension") continue;
            const Result<std::int64_t> value = words.integer();
            if (!value || *value < 1) return scan_.error(fmt::format("a count is needed after {}", word));
            if (word == "dimension" && *value != 3)
                return scan_.error(fmt::format("dimension {}: tetrahedra need three", *value));
            if (word == "nnode") block_.width = static_cast<std::size_t>(*value);
        }
        if (block_.tets && block_.width != 4 && block_.width != 10)
            return scan_.error(fmt::format("tetrahedra of {} nodes are not read; 4 or 10 are", block_.width));
        return {};
    }

    /// True at "end ..."; moves past that line.
    bool at_end_of(TextScanner& ahead) {
        ahead = scan_;
        if (lower_case(scan_.word()) != "end") {
            scan_ = ahead;
            return false;
        }
        scan_.rest_of_line();
        return true;
    }

    Status read_coordinates() {
        for (TextScanner before = scan_; !at_end_of(before);) {
            const Result<std::int64_t> number = scan_.integer();
            if (!number) return tl::unexpected(number.error());
            const Result<Vec3> p = read_point(scan_);
            if (!p) return tl::unexpected(p.error());
            if (!found_.points.add(*number, *p)) return scan_.error(fmt::format("node {} comes twice", *number));
        }
        return {};
    }

    Status read_elements() {
        for (TextScanner before = scan_; !at_end_of(before);) {
            const Result<std::int64_t> number = scan_.integer();
            if (!number) return tl::unexpected(number.error());
            if (block_.tets) {
                const Result<TenNodes> nodes = read_tet_nodes(scan_, found_.points, block_.width);
                if (!nodes) return tl::unexpected(nodes.error());
                found_.tets.push_back(*nodes);
                found_.regions.push_back(region_of(scan_.rest_of_line()));
            } else {
                scan_.rest_of_line();
            }
        }
        return {};
    }

    /// The material number, which follows the nodes. Elements without one get their block as region, with negative
    /// numbers to tell blocks from materials.
    std::int64_t region_of(std::string_view rest) {
        TextScanner words(rest, name_);
        if (const Result<std::int64_t> material = words.integer(); material && *material >= 0) return *material;
        const std::int64_t region = block_.name.empty() ? 0 : -block_.number;
        if (region < 0) found_.names[region] = block_.name;
        return region;
    }

    TextScanner scan_;
    std::string name_;
    TextTets found_;
    Block block_;
};

}  // namespace

Result<TetMesh> parse_gid(std::string_view bytes, const std::string& name) {
    return GidReader(bytes, name).read();
}

}  // namespace pliant::mesh
