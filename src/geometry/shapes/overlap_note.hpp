// What is said of two solids that share space: the later one keeps it.
#pragma once

#include <fmt/format.h>

#include <string>

namespace pliant::mesh {

/// `volume`: in the cube of the file's unit.
[[nodiscard]] inline std::string overlap_note(const std::string& earlier, const std::string& later, double volume) {
    return fmt::format(
        "\"{0}\" and \"{1}\" overlap in a volume of {2:.6g} (in the file's unit, cubed), which belongs to "
        "\"{1}\", the later one",
        earlier, later, volume);
}

}  // namespace pliant::mesh
