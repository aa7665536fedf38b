// Winding numbers of very many points with respect to one surface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh/triangle_tree.hpp"

namespace pliant::mesh {

/// The winding number of a surface without a border is an integer, and the same at two points unless the surface passes
/// between them. So space is divided into boxes, each of which stores the number of one of its points; for another
/// point only the triangles of the box that lie in between are counted. A surface with a short border is treated as a
/// closed one minus the caps that would close it.
class WindingGrid {
public:
    /// Cost: n log n, plus some nanoseconds for each box, of which there are four million at most.
    explicit WindingGrid(TriMesh surface);

    /// As TriangleTree's. An integer if the surface has no border; the tree is used if the border is long, the box is
    /// crowded, or rounding might decide on which side of a triangle a point lies.
    [[nodiscard]] double winding_number(const Vec3& point) const;

    [[nodiscard]] const TriMesh& surface() const { return tree_.surface(); }
    [[nodiscard]] const Box3& box() const { return box_; }

private:
    using Place = std::array<int, 3>;  ///< index of a box in the grid

    /// The triangles that may reach into the box, by number.
    [[nodiscard]] std::span<const int> triangles(std::size_t cell) const;
    [[nodiscard]] std::size_t index(const Place& place) const;
    /// The extent of the box.
    [[nodiscard]] Box3 cell_box(const Place& place) const;
    /// The point of the box whose winding number is stored.
    [[nodiscard]] Vec3 reference(const Place& place) const;
    [[nodiscard]] std::pair<Place, Place> places_of(const Box3& box) const;

    void choose_cells();
    [[nodiscard]] double work() const;
    void list_triangles();
    void find_references();
    /// Winding number at `b` minus that at `a`, both in the cell; nothing if rounding leaves it unclear.
    [[nodiscard]] std::optional<int> change(std::size_t cell, const Vec3& a, const Vec3& b) const;
    [[nodiscard]] int asked_of_trees(const Vec3& point) const;

    TriangleTree tree_;
    TriangleTree caps_;  ///< that close the surface
    TriMesh closed_;     ///< the surface and its caps
    Box3 box_;
    Place count_{};                     ///< number of boxes along x, y and z; zero if the border is long
    Vec3 side_;                         ///< size of a box
    std::vector<std::uint32_t> begin_;  ///< (cells + 1) of a cell's triangles in `listed_`
    std::vector<int> listed_;
    std::vector<std::int16_t> winding_;  ///< (cells) winding number of the reference point
};

}  // namespace pliant::mesh
