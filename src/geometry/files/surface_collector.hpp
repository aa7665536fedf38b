// Shared by the readers of surface files: collects points and faces in the order of the file.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/files/surface_file.hpp"
#include "geometry/files/text_scanner.hpp"
#include "geometry/mesh/point_welder.hpp"

namespace pliant::mesh {

/// Vertices by number; vertices at the same place become one point. Faces of any number of corners, which are split
/// into triangles from their first corner.
class SurfaceCollector {
public:
    /// Reads the next three words as a vertex.
    [[nodiscard]] Status read_vertex(TextScanner& scan);
    /// Precondition: finite.
    void add_vertex(const Vec3& p) { place_.push_back(welder_.add(p)); }
    [[nodiscard]] std::size_t vertex_count() const { return place_.size(); }

    void begin_face() { corners_ = 0; }
    /// Adds the next corner of the face: vertex number `vertex`, from 0. Precondition: the vertex exists.
    void add_corner(std::size_t vertex) {
        const int point = place_[vertex];
        if (corners_ == 0) first_ = point;
        if (corners_ >= 2) file_.mesh.triangles.push_back({first_, before_, point});
        before_ = point;
        ++corners_;
    }
    /// Of the current face.
    [[nodiscard]] std::size_t corner_count() const { return corners_; }

    /// Holds what was collected except the points, which take() adds.
    [[nodiscard]] SurfaceFile& file() { return file_; }
    /// The result; leaves the collector empty.
    [[nodiscard]] SurfaceFile take();

private:
    PointWelder welder_;
    std::vector<int> place_;  ///< welded index of each vertex of the file
    SurfaceFile file_;
    int first_ = -1, before_ = -1;
    std::size_t corners_ = 0;
};

}  // namespace pliant::mesh
