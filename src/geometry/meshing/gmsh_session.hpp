// A session with Gmsh, inside this folder.
#pragma once

#include <exception>
#include <new>
#include <string_view>

#include "base/core/error.hpp"
#include "geometry/meshing/gmsh_calls.hpp"

namespace pliant::mesh::kernel {

/// A separate Gmsh model, silent and reproducible.
class Session {
public:
    Session() {
        gmsh::initialize();
        gmsh::option::set_number("General.Terminal", 0);
        gmsh::option::set_number("General.AbortOnError", 2);  // throw exceptions
        gmsh::option::set_number("General.NumThreads", 1);
        gmsh::option::set_number("Mesh.RandomSeed", 1);
        gmsh::option::set_number("Mesh.Algorithm", 6);    // frontal Delaunay on surfaces
        gmsh::option::set_number("Mesh.Algorithm3D", 1);  // Delaunay in volumes
        gmsh::option::set_number("Mesh.Optimize", 1);
        gmsh::model::add("pliant");
    }
    ~Session() {
        try {
            gmsh::finalize();
        } catch (...) {  // nothing can be done about it, and a destructor must not throw
        }
    }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;
};

/// Runs `work` in a session; exceptions from Gmsh become errors.
template <class Work>
auto in_session(std::string_view task, const Work& work) -> decltype(work()) {
    try {
        const Session session;
        return work();
    } catch (const std::bad_alloc&) {
        throw;  // the caller handles the limit
    } catch (const std::exception& error) {
        return failure("{}: Gmsh says: {}", task, error.what());
    } catch (...) {
        return failure("{}: Gmsh failed without a reason", task);
    }
}

/// Edges of at most this length, which only what is set besides makes shorter.
inline void set_size(double size) {
    gmsh::option::set_number("Mesh.MeshSizeMax", size);
    gmsh::option::set_number("Mesh.MeshSizeMin", 0);
    gmsh::option::set_number("Mesh.MeshSizeFromPoints", 0);
    gmsh::option::set_number("Mesh.MeshSizeExtendFromBoundary", 1);
}

}  // namespace pliant::mesh::kernel
