#include "geometry/files/text_tets.hpp"

#include "geometry/files/tet_collector.hpp"

namespace pliant::mesh {

Result<Vec3> read_point(TextScanner& scan) {
    Vec3 p;
    for (std::size_t k = 0; k < 3; ++k) {
        const Result<double> one = scan.number();
        if (!one) return tl::unexpected(one.error());
        p[k] = *one;
    }
    return p;
}

Result<TenNodes> read_tet_nodes(TextScanner& scan, const NumberedPoints& points, std::size_t width) {
    TenNodes nodes;
    nodes.fill(-1);
    for (std::size_t a = 0; a < width; ++a) {
        const Result<std::int64_t> number = scan.integer();
        if (!number) return tl::unexpected(number.error());
        nodes[a] = points.find(*number);
        if (nodes[a] < 0)
            return scan.error(fmt::format("a tetrahedron refers to node {}, which does not exist", *number));
    }
    return nodes;
}

Result<TetMesh> finish(TextTets&& read, const std::string& name) {
    const auto width = [](const TenNodes& tet) { return tet.back() < 0 ? std::size_t{4} : std::size_t{10}; };
    const std::vector<Vec3> points = read.points.take();
    std::vector<TenNodes> quadratic;
    for (const TenNodes& tet : read.tets) {
        if (width(tet) == 10) quadratic.push_back(tet);
    }
    if (!quadratic.empty()) {
        if (Status status = order_mid_edge_nodes(points, quadratic); !status)
            return input_error("{}: {}", name, status.error().message);
        std::size_t next = 0;
        for (TenNodes& tet : read.tets) {
            if (width(tet) == 10) tet = quadratic[next++];
        }
    }
    TetCollector collector(points);
    for (std::size_t t = 0; t < read.tets.size(); ++t) {
        Status status = collector.add(std::span(read.tets[t]).first(width(read.tets[t])), read.regions[t]);
        if (!status) return input_error("{}: tetrahedron {}: {}", name, t + 1, status.error().message);
    }
    Result<TetMesh> mesh = collector.finish(read.names);
    if (!mesh) return input_error("{}: {}", name, mesh.error().message);
    return mesh;
}

}  // namespace pliant::mesh
