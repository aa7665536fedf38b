#include "presentation/print_report/material_colours.hpp"

namespace pliant::report {

std::vector<Colour> material_colours(const job::Manifest& job) {
    std::vector<Colour> colours;
    for (const job::Material& material : job.materials) {
        colours.push_back(material.colour.empty() ? palette(static_cast<int>(colours.size()))
                                                  : colour_of_hex(material.colour));
    }
    return colours;
}

}  // namespace pliant::report
