// Receives a geometry file from a page: writes it to a temporary file piece by piece, checks it with its reader, and
// only then moves it into the project folder.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "studio/files/geometry_content.hpp"
#include "studio/requests/project_folder.hpp"

namespace pliant::studio {

/// Larger files are refused and deleted.
inline constexpr long long largest_geometry = 256LL << 20;

/// Reads the next bytes of a body; 0 at its end, negative if the connection broke.
using ReadMore = std::function<long long(char* into, std::size_t most)>;

/// A plain file name with the extension of a supported format: no folders, no hidden files, no control characters.
/// Errors say what would be right.
[[nodiscard]] Status check_geometry_name(std::string_view name);

enum class Received { written, same_as_there, name_is_taken };

struct ReceivedGeometry {
    Received how = Received::written;
    GeometryContent content;
};

/// `length`: of the body, negative if unknown. An existing file is kept unless `replace`; one with the same bytes
/// counts as received. Errors: the name; too large; a broken connection; a write error; those of the reader, with the
/// file's own name.
[[nodiscard]] Result<ReceivedGeometry> receive_geometry(const ProjectFolder& folder, const std::string& name,
                                                        bool replace, long long length, const ReadMore& more,
                                                        long long largest = largest_geometry);

}  // namespace pliant::studio
