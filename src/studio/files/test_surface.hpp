// A small surface for the tests of the studio.
#pragma once

#include <fmt/format.h>

#include <string>

namespace pliant::studio::test {

/// A tetrahedron with legs of `size` along the axes, as the text of an STL file.
inline std::string tetra(int size) {
    const std::string o = "0 0 0", x = fmt::format("{} 0 0", size), y = fmt::format("0 {} 0", size),
                      z = fmt::format("0 0 {}", size);
    std::string text = "solid t\n";
    const auto facet = [&](const std::string& a, const std::string& b, const std::string& c) {
        text += fmt::format("facet normal 0 0 0\nouter loop\nvertex {}\nvertex {}\nvertex {}\nendloop\nendfacet\n", a,
                            b, c);
    };
    facet(o, y, x);
    facet(o, x, z);
    facet(o, z, y);
    facet(x, y, z);
    return text + "endsolid t\n";
}

}  // namespace pliant::studio::test
