// The program pliant-mesh, which meshes for others: Gmsh, Open CASCADE and CGAL run in a process of their own. What
// crashes there, or never ends, is one error here; what is cancelled ends at once; and their licence (GPL) is that of
// pliant-mesh alone.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "geometry/mesher/message_pipe.hpp"

namespace pliant::mesh {

/// Of one request. From the environment: PLIANT_MESH_SECONDS and PLIANT_MESH_GIGABYTES.
struct MesherLimits {
    double seconds = 3600;
    double gigabytes = 0;  ///< of memory; 0: what the computer has
};
[[nodiscard]] MesherLimits mesher_limits();

/// Where pliant-mesh is: what PLIANT_MESH names, else beside the running program or the library that this is part of,
/// else where it was built, else where it is installed with a program of PATH.
[[nodiscard]] Result<std::filesystem::path> mesher_program();

/// The first that belongs to a folder of programs in `search_path`, as PATH has them; empty: there is none.
[[nodiscard]] std::filesystem::path mesher_on(std::string_view search_path);

/// Has a request answered by a process that is kept for the next one. Any thread may ask; requests at one time run in
/// processes of their own. Errors: those of the mesher; `crash`, with the reason, where its process dies; that it took
/// longer than the limit; cancellation, which ends the process.
[[nodiscard]] Result<std::string> ask_mesher(MessageKind kind, const std::string& request, const std::string& crash,
                                             Progress& progress);

/// From now on the last answers are kept, of up to so many bytes with their requests, and a request that comes again
/// gets its answer without the mesher: for a process that builds the same bodies again and again. 0: none, as in the
/// beginning. A STEP file is read anew each time, but a mesh made from it is not.
void remember_answers(std::size_t bytes);

}  // namespace pliant::mesh
