// Winding numbers of very many points around one surface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh/triangle_tree.hpp"

namespace pliant::mesh {

/// A surface without a border winds around all points a whole number of times, and as often around two points unless it
/// passes between them. So space is divided into boxes that know the number of one of their points: another point of
/// the box has it too, but for the triangles of the box that lie between. A surface with a short border is one without
/// less the caps that would close it.
class WindingGrid {
public:
    /// Cost: n log n and some nanoseconds for each box, of which there are four million at most.
    explicit WindingGrid(TriMesh surface);

    /// As TriangleTree's. A whole number where the surface has no border; the tree is asked where the border is long,
    /// where a box is crowded, and where rounding may decide on which side of a triangle a point lies.
    [[nodiscard]] double winding_number(const Vec3& point) const;

    [[nodiscard]] const TriMesh& surface() const { return tree_.surface(); }
    [[nodiscard]] const Box3& box() const { return box_; }

private:
    using Place = std::array<int, 3>;  ///< of a box of the grid

    /// Of the surface that a box may hold, in numbers of its triangles.
    [[nodiscard]] std::span<const int> triangles(std::size_t cell) const;
    [[nodiscard]] std::size_t index(const Place& place) const;
    /// Where the box lies.
    [[nodiscard]] Box3 cell_box(const Place& place) const;
    /// The point of the box whose winding number it knows.
    [[nodiscard]] Vec3 reference(const Place& place) const;
    [[nodiscard]] std::pair<Place, Place> places_of(const Box3& box) const;

    void choose_cells();
    [[nodiscard]] double work() const;
    void list_triangles();
    void find_references();
    /// How often more the surface winds around `b` than around `a`, both in the cell; nothing if that is not clear.
    [[nodiscard]] std::optional<int> change(std::size_t cell, const Vec3& a, const Vec3& b) const;
    [[nodiscard]] int asked_of_trees(const Vec3& point) const;

    TriangleTree tree_;
    TriangleTree caps_;  ///< that the surface lacks
    TriMesh closed_;     ///< the surface and its caps
    Box3 box_;
    Place count_{};                     ///< of boxes along x, y and z; none where the border is long
    Vec3 side_;                         ///< of a box
    std::vector<std::uint32_t> begin_;  ///< (cells + 1) of a cell's triangles in `listed_`
    std::vector<int> listed_;
    std::vector<std::int16_t> winding_;  ///< (cells) number of the reference point
};

}  // namespace pliant::mesh
