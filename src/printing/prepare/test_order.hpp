// A small printer and a part of two materials for the tests of this module.
#pragma once

#include "printing/prepare/settings.hpp"

namespace pliant::prepare::test {

inline machine::Printer printer() {
    machine::Printer p;
    p.layer_um = 50;
    p.projector.width_px = 200;
    p.projector.height_px = 100;
    p.projector.pixel_um = 100;
    machine::Resin soft, firm;
    soft.name = "soft";
    soft.exposure_s = 2;
    soft.bottom_exposure_s = 9;
    soft.bottom_layers = 3;
    firm.name = "firm";
    firm.exposure_s = 4;
    firm.bottom_exposure_s = 8;
    firm.bottom_layers = 2;
    p.resins = {soft, firm};
    p.vats = {{1, "soft", 100}, {2, "firm", 100}};
    return p;
}

inline mesh::TriMesh box_um(const Vec3& low, const Vec3& high) {
    mesh::TriMesh mesh;
    for (std::size_t i = 0; i < 8; ++i)
        mesh.points.push_back({i % 2 == 0 ? low.x : high.x, i / 2 % 2 == 0 ? low.y : high.y, i < 4 ? low.z : high.z});
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

/// Two blocks of 4 x 4 x 3 mm side by side, not drawn on the platform.
inline Drawing two_blocks() {
    Drawing d;
    d.name = "blocks";
    d.bodies = {{"soft", box_um({10000, 0, 5000}, {14000, 4000, 8000}), "left"},
                {"firm", box_um({14000, 0, 5000}, {18000, 4000, 8000}), "right"}};
    d.resin_of_material = {{"soft", "soft"}, {"firm", "firm"}};
    return d;
}

}  // namespace pliant::prepare::test
