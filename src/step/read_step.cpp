#include "step/read_step.hpp"

#include <gmsh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <mutex>
#include <vector>

namespace pliant::step {
namespace {

namespace occ = gmsh::model::occ;
using Entities = gmsh::vectorpair;  ///< (dimension, tag)

/// A Gmsh model of its own, silent and reproducible.
class Session {
public:
    Session() : lock_(mutex()) {
        gmsh::initialize(0, nullptr, false);
        gmsh::option::setNumber("General.Terminal", 0);
        gmsh::option::setNumber("General.AbortOnError", 2);  // throw
        gmsh::option::setNumber("General.NumThreads", 1);
        gmsh::option::setNumber("Mesh.RandomSeed", 1);
        gmsh::option::setString("Geometry.OCCTargetUnit", "MM");
        gmsh::model::add("step");
    }
    ~Session() {
        try {
            gmsh::finalize();
        } catch (...) {  // nothing is left to be done about it, and a destructor must not throw
        }
    }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

private:
    static std::mutex& mutex() {
        static std::mutex one;
        return one;
    }
    std::lock_guard<std::mutex> lock_;
};

/// Chords on arcs, as few triangles as possible on what is flat.
void make_triangles(const Entities& solids) {
    double longest = 0;
    for (const auto& [dimension, tag] : solids) {
        std::array<double, 6> b{};
        occ::getBoundingBox(dimension, tag, b[0], b[1], b[2], b[3], b[4], b[5]);
        longest = std::max(longest, std::hypot(b[3] - b[0], b[4] - b[1], b[5] - b[2]));
    }
    constexpr double chords_a_turn = 120;
    gmsh::option::setNumber("Mesh.MeshSizeMax", 2 * longest);
    gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", chords_a_turn);
    gmsh::model::mesh::generate(2);
}

/// Appends the faces of one solid, turned outwards.
void add_solid(const std::pair<int, int>& solid, mesh::TriMesh& mesh) {
    Entities faces;
    gmsh::model::getBoundary({solid}, faces, false, true, false);
    std::map<std::size_t, int> numbers;  // points are one where faces meet
    for (const auto& [dimension, signed_tag] : faces) {
        const int tag = std::abs(signed_tag);
        std::vector<std::size_t> nodes;
        std::vector<double> places, parameters;
        gmsh::model::mesh::getNodes(nodes, places, parameters, dimension, tag, true, false);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            if (!numbers.try_emplace(nodes[i], static_cast<int>(mesh.points.size())).second) continue;
            mesh.points.push_back({places[3 * i], places[3 * i + 1], places[3 * i + 2]});
        }
        std::vector<std::size_t> elements, corners;
        constexpr int triangle = 2;
        gmsh::model::mesh::getElementsByType(triangle, elements, corners, tag);
        for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
            std::array<int, 3> t{numbers.at(corners[i]), numbers.at(corners[i + 1]), numbers.at(corners[i + 2])};
            if (signed_tag < 0) std::swap(t[1], t[2]);
            mesh.triangles.push_back(t);
        }
    }
}

Result<StepFile> read(const std::string& path) {
    Entities solids, imported;
    occ::importShapes(path, imported, true, "step");
    for (const auto& entity : imported) {
        if (entity.first == 3) solids.push_back(entity);
    }
    if (solids.empty()) return input_error("{}: holds no solid", path);
    occ::synchronize();
    make_triangles(solids);
    StepFile file;
    file.solids = static_cast<int>(solids.size());
    for (const auto& solid : solids) {
        double volume = 0;
        occ::getMass(solid.first, solid.second, volume);
        file.volume_mm3 += volume;
        add_solid(solid, file.surface_mm);
    }
    const double found = mesh::signed_volume(file.surface_mm);
    constexpr double tolerance = 2e-3;
    if (!(std::fabs(found - file.volume_mm3) <= tolerance * file.volume_mm3))
        return input_error("{}: its triangles enclose {:.6g} mm^3, its solids {:.6g} mm^3", path, found,
                           file.volume_mm3);
    return file;
}

}  // namespace

bool looks_like_step(std::string_view bytes) {
    return bytes.substr(0, 13) == "ISO-10303-21;";
}

Result<StepFile> read_step(const std::filesystem::path& path) {
    try {
        const Session session;
        return read(path.string());
    } catch (const std::string& text) {
        return input_error("{}: cannot be read as STEP: {}", path.string(), text);
    } catch (const std::exception& error) {
        return input_error("{}: cannot be read as STEP: {}", path.string(), error.what());
    } catch (...) {
        return input_error("{}: cannot be read as STEP", path.string());
    }
}

}  // namespace pliant::step
