// TetGen's .node and .ele files. Format: H. Si, TetGen manual, "File formats". Points are numbered from 0 or from 1,
// whichever the first one has. The first attribute of a tet is its region.
#include <cmath>

#include "geometry/files/tet_file.hpp"
#include "geometry/files/text_tets.hpp"

namespace pliant::mesh {
namespace {

/// The numbers of the first line, at most four; missing ones are 0.
struct Head {
    std::size_t count = 0;
    std::int64_t second = 0, third = 0, fourth = 0;
};

/// Moves to the next line that is neither blank nor a comment.
void skip_comments(TextScanner& scan) {
    for (TextScanner ahead = scan; ahead.word().starts_with('#'); ahead = scan) {
        ahead.rest_of_line();
        scan = ahead;
    }
}

Result<Head> read_head(TextScanner& scan, std::size_t least_bytes) {
    skip_comments(scan);
    Head head;
    const Result<std::size_t> count = scan.count(least_bytes);
    if (!count) return tl::unexpected(count.error());
    head.count = *count;
    TextScanner rest(scan.rest_of_line(), "");
    for (std::int64_t* value : {&head.second, &head.third, &head.fourth}) {
        if (const Result<std::int64_t> one = rest.integer()) *value = *one;
    }
    return head;
}

Status read_nodes(TextScanner& scan, NumberedPoints& points) {
    const Result<Head> head = read_head(scan, 8);
    if (!head) return tl::unexpected(head.error());
    if (head->second != 3) return scan.error(fmt::format("points of dimension {}, 3 is needed", head->second));
    points.reserve(head->count);
    for (std::size_t i = 0; i < head->count; ++i) {
        skip_comments(scan);
        const Result<std::int64_t> number = scan.integer();
        if (!number) return tl::unexpected(number.error());
        const Result<Vec3> p = read_point(scan);
        if (!p) return tl::unexpected(p.error());
        scan.rest_of_line();  // attributes and boundary marker
        if (!points.add(*number, *p)) return scan.error(fmt::format("point {} comes twice", *number));
    }
    return {};
}

Status read_tets(TextScanner& scan, TextTets& found) {
    const Result<Head> head = read_head(scan, 8);
    if (!head) return tl::unexpected(head.error());
    if (head->second != 4 && head->second != 10)
        return scan.error(fmt::format("tetrahedra of {} nodes are not read; 4 or 10 are", head->second));
    for (std::size_t i = 0; i < head->count; ++i) {
        skip_comments(scan);
        if (const Result<std::int64_t> number = scan.integer(); !number) return tl::unexpected(number.error());
        const Result<TenNodes> nodes = read_tet_nodes(scan, found.points, static_cast<std::size_t>(head->second));
        if (!nodes) return tl::unexpected(nodes.error());
        std::int64_t region = 0;
        if (head->third > 0) {
            const Result<double> attribute = scan.number();
            if (!attribute) return tl::unexpected(attribute.error());
            if (std::fabs(*attribute) < 1e9) region = std::llround(*attribute);
        }
        scan.rest_of_line();
        found.tets.push_back(*nodes);
        found.regions.push_back(region);
    }
    return {};
}

}  // namespace

Result<TetMesh> parse_tetgen(std::string_view nodes, const std::string& nodes_name, std::string_view tets,
                             const std::string& tets_name) {
    TextTets found;
    TextScanner node_scan(nodes, nodes_name);
    if (Status status = read_nodes(node_scan, found.points); !status) return tl::unexpected(status.error());
    TextScanner tet_scan(tets, tets_name);
    if (Status status = read_tets(tet_scan, found); !status) return tl::unexpected(status.error());
    return finish(std::move(found), tets_name);
}

}  // namespace pliant::mesh
