// What the readers of surface files share: points and faces in the order of a file.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/files/surface_file.hpp"
#include "geometry/files/text_scanner.hpp"
#include "geometry/mesh/point_welder.hpp"

namespace pliant::mesh {

/// Vertices by their numbers, of which those at one place become one point; faces of any number of corners, which are
/// cut into triangles from their first corner.
class SurfaceCollector {
public:
    /// The next three words of a text.
    [[nodiscard]] Status read_vertex(TextScanner& scan);
    /// Precondition: finite.
    void add_vertex(const Vec3& p) { place_.push_back(welder_.add(p)); }
    [[nodiscard]] std::size_t vertex_count() const { return place_.size(); }

    void begin_face() { corners_ = 0; }
    /// The next corner of the face: the vertex of this number, from 0. Precondition: it is there.
    void add_corner(std::size_t vertex) {
        const int point = place_[vertex];
        if (corners_ == 0) first_ = point;
        if (corners_ >= 2) file_.mesh.triangles.push_back({first_, before_, point});
        before_ = point;
        ++corners_;
    }
    /// Of the face that was begun last.
    [[nodiscard]] std::size_t corner_count() const { return corners_; }

    /// With what was collected; its points come with take().
    [[nodiscard]] SurfaceFile& file() { return file_; }
    /// Leaves the collector empty.
    [[nodiscard]] SurfaceFile take();

private:
    PointWelder welder_;
    std::vector<int> place_;  ///< welded index of each vertex of the file
    SurfaceFile file_;
    int first_ = -1, before_ = -1;
    std::size_t corners_ = 0;
};

}  // namespace pliant::mesh
