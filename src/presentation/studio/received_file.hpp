// A file of geometry that a page sends: written aside piece by piece, read by its reader, and only then put into the
// project folder under its name.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "presentation/studio/geometry_content.hpp"
#include "presentation/studio/project_folder.hpp"

namespace pliant::studio {

/// More than this is refused, and nothing of it stays.
inline constexpr long long largest_geometry = 256LL << 20;

/// The next bytes of a body; 0 at its end, negative where the line broke.
using ReadMore = std::function<long long(char* into, std::size_t most)>;

/// A plain name with the ending of a format that is read: no folders, nothing hidden, no control characters. Errors say
/// what would be right.
[[nodiscard]] Status check_geometry_name(std::string_view name);

enum class Received { written, same_as_there, name_is_taken };

struct ReceivedGeometry {
    Received how = Received::written;
    GeometryContent content;
};

/// `length`: of the body, negative where it is not known. A file of that name stays unless `replace`; one of the same
/// bytes counts as received. Errors: the name; too large; the line broke; the disk; those of the reader, in which the
/// file has its own name.
[[nodiscard]] Result<ReceivedGeometry> receive_geometry(const ProjectFolder& folder, const std::string& name,
                                                        bool replace, long long length, const ReadMore& more,
                                                        long long largest = largest_geometry);

}  // namespace pliant::studio
