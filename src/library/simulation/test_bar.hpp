// A robot for the tests of the library.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "pliant/simulation.hpp"

namespace pliant::test {

/// A bar of 60 mm with a cable along its upper side, and whatever `more` says.
inline std::string bar_text(const std::string& more = "") {
    return R"(
        name = "bar"
        length_unit = "mm"
        material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45, density = "1100 kg/m^3" }
        mesh = { order = 1, size = "5 mm" }
        body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [60, 10, 10]] } }]
        fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }]
        marker = [{ name = "tip", point = [60, 5, 5] }]
        cable = [{ name = "flexor", points = [[0, 5, 9], [30, 5, 9], [60, 5, 9]], target.shortening = "4 mm", )"
           R"(range = ["0 mm", "8 mm"] }]
    )" + more;
}

inline Robot bar(const std::string& more = "") {
    return Robot::parse(bar_text(more));
}

inline void write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file) << text;
}

}  // namespace pliant::test
