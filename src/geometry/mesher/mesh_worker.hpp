// The worker program pliant-mesh runs Gmsh, Open CASCADE and CGAL in a process of its own. A crash or an endless loop
// there becomes an error here, cancellation takes effect at once, and the GPL applies to pliant-mesh alone.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "geometry/mesher/message_pipe.hpp"

namespace pliant::mesh {

/// Limits per request. From the environment: PLIANT_MESH_SECONDS and PLIANT_MESH_GIGABYTES.
struct MesherLimits {
    double seconds = 3600;
    double gigabytes = 0;  ///< of memory; 0: all of the computer's
};
/// Errors: one of them is no positive number.
[[nodiscard]] Result<MesherLimits> mesher_limits();

/// Where pliant-mesh is: the path in PLIANT_MESH, else mesher_from() the folders of the library that contains this code
/// and of the running program, else mesher_on() PATH. No path of where it was built is known.
[[nodiscard]] Result<std::filesystem::path> mesher_program();

/// That of the first folder of programs or libraries which has one: in it, in libexec/pliant or bin beside it, or in
/// the build tree around it, which has CMakeCache.txt and apps/pliant/pliant-mesh. Relative folders are left out;
/// empty: none.
[[nodiscard]] std::filesystem::path mesher_from(std::span<const std::filesystem::path> folders);

/// The first one that belongs to a folder of `search_path`, which has the format of PATH; empty: none.
[[nodiscard]] std::filesystem::path mesher_on(std::string_view search_path);

/// Sends a request to a worker process, which is kept for the next one. Thread-safe; concurrent requests use separate
/// processes, and so do a program and its forks. Errors: those of the mesher; `crash` and the reason, if its process
/// dies; timeout; cancellation, which kills the process.
[[nodiscard]] Result<std::string> ask_mesher(MessageKind kind, const std::string& request, const std::string& crash,
                                             Progress& progress);

/// From now on caches the latest answers, up to this many bytes with their requests, and answers a repeated request
/// from the cache: for a process that builds the same bodies repeatedly. 0, the initial state: no cache. A STEP file is
/// always read again; a mesh made from it is cached.
void remember_answers(std::size_t bytes);

}  // namespace pliant::mesh
