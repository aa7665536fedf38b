#include "simulation/peers/reference_problems.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace pliant::sim::reference {
namespace {

/// The six tets of one cell, as corners (0 or 1 on each axis), mirrored on the axes where `mirror` is set.
void append_cell(mesh::TetMesh& mesh, const std::array<int, 3>& cell, const std::array<int, 3>& cells) {
    std::array<int, 3> axes = {0, 1, 2};
    const auto node = [&](std::array<int, 3> corner) {
        for (std::size_t a = 0; a < 3; ++a) {
            if (cell[a] % 2 == 1) corner[a] = 1 - corner[a];
            corner[a] += cell[a];
        }
        return (corner[0] * (cells[1] + 1) + corner[1]) * (cells[2] + 1) + corner[2];
    };
    do {
        std::array<int, 3> corner = {0, 0, 0};
        std::array<int, 4> tet = {node(corner), 0, 0, 0};
        for (std::size_t step = 0; step < 3; ++step) {
            corner[static_cast<std::size_t>(axes[step])] = 1;
            tet[step + 1] = node(corner);
        }
        const auto& p = mesh.points;
        if (mesh::signed_tet_volume(p[tet[0]], p[tet[1]], p[tet[2]], p[tet[3]]) < 0) std::swap(tet[2], tet[3]);
        mesh.nodes.insert(mesh.nodes.end(), tet.begin(), tet.end());
    } while (std::next_permutation(axes.begin(), axes.end()));
}

}  // namespace

mesh::TetMesh kuhn_box(Vec3 size, int nx, int ny, int nz, const std::function<int(Vec3)>& region_of) {
    mesh::TetMesh mesh;
    for (int i = 0; i <= nx; ++i) {
        for (int j = 0; j <= ny; ++j) {
            for (int k = 0; k <= nz; ++k) mesh.points.push_back({size.x * i / nx, size.y * j / ny, size.z * k / nz});
        }
    }
    for (int i = 0; i < nx; ++i) {
        for (int j = 0; j < ny; ++j) {
            for (int k = 0; k < nz; ++k) append_cell(mesh, {i, j, k}, {nx, ny, nz});
        }
    }
    int regions = 1;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        Vec3 centroid;
        for (const int n : mesh.tet(t)) centroid += 0.25 * mesh.points[n];
        mesh.region.push_back(region_of(centroid));
        regions = std::max(regions, mesh.region.back() + 1);
    }
    for (int r = 0; r < regions; ++r) mesh.region_names.push_back("region " + std::to_string(r));
    return mesh;
}

NamedMesh load_tet(const std::string& path, double unit) {
    std::ifstream in(path);
    std::size_t nodes = 0;
    std::size_t tets = 0;
    if (!(in >> nodes >> tets)) throw std::runtime_error("cannot read " + path);
    NamedMesh named;
    named.mesh.points.resize(nodes);
    for (Vec3& p : named.mesh.points) {
        in >> p.x >> p.y >> p.z;
        p *= unit;
    }
    named.mesh.nodes.resize(4 * tets);
    named.mesh.region.resize(tets);
    for (std::size_t t = 0; t < tets; ++t) {
        for (std::size_t a = 0; a < 4; ++a) in >> named.mesh.nodes[4 * t + a];
        in >> named.mesh.region[t];
    }
    named.mesh.region_names = {"region 0", "region 1"};
    std::size_t sets = 0;
    in >> sets;
    for (std::size_t s = 0; s < sets; ++s) {
        std::string name;
        std::size_t count = 0;
        in >> name >> count;
        std::vector<int>& list = named.sets[name];
        list.resize(count);
        for (int& n : list) in >> n;
    }
    if (!in) throw std::runtime_error("cannot read " + path);
    return named;
}

std::vector<Row> load_csv(const std::string& path) {
    std::ifstream in(path);
    std::string line;
    const auto split = [](const std::string& text) {
        std::vector<std::string> cells;
        std::istringstream stream(text);
        for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
        return cells;
    };
    if (!std::getline(in, line)) throw std::runtime_error("cannot read " + path);
    const auto names = split(line);
    std::vector<Row> rows;
    while (std::getline(in, line)) {
        const auto cells = split(line);
        Row row;
        for (std::size_t i = 0; i < std::min(names.size(), cells.size()); ++i) row[names[i]] = cells[i];
        rows.push_back(std::move(row));
    }
    return rows;
}

std::vector<int> nodes_where(const mesh::TetMesh& mesh, const std::function<bool(Vec3)>& inside) {
    std::vector<int> nodes;
    for (std::size_t n = 0; n < mesh.points.size(); ++n) {
        if (inside(mesh.points[n])) nodes.push_back(static_cast<int>(n));
    }
    return nodes;
}

Attachment mean_of(std::vector<int> nodes) {
    std::vector<double> weights(nodes.size(), 1.0 / static_cast<double>(nodes.size()));
    return {std::move(nodes), std::move(weights), {}};
}

std::string data_folder() {
    const char* folder = std::getenv("PLIANT_REFERENCE_DATA");
    return folder != nullptr ? folder : "";
}

}  // namespace pliant::sim::reference
