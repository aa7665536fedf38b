#include "printing/slice/layer_shape.hpp"

#include <algorithm>
#include <numeric>

namespace pliant::slice {
namespace {

/// Union-find over numbers.
class Sets {
public:
    explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
    std::uint32_t root(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    /// The smaller number remains the root.
    void join(std::uint32_t a, std::uint32_t b) {
        a = root(a);
        b = root(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::uint32_t> parent_;
};

/// The solid stretches of a row: runs of all images, merged where they touch or, if exposed twice, overlap.
void solid_row(const ComposedLayer& layer, int row, std::vector<Stretch>& stretches) {
    const std::size_t first = stretches.size();
    for (const MaterialImage& m : layer.images) {
        for (const Run& run : m.image.row(row)) {
            if (run.value >= solid_value) stretches.push_back({run.begin, run.end, 0});
        }
    }
    const auto begin = stretches.begin() + static_cast<std::ptrdiff_t>(first);
    if (layer.images.size() > 1)
        std::sort(begin, stretches.end(), [](const Stretch& l, const Stretch& r) { return l.begin < r.begin; });
    auto last = begin;
    for (auto it = begin; it != stretches.end(); ++it) {
        if (it != begin && it->begin <= last->end) {
            last->end = std::max(last->end, it->end);
        } else {
            if (it != begin) ++last;
            *last = *it;
        }
    }
    if (begin != stretches.end()) stretches.erase(last + 1, stretches.end());
}

/// The gaps between the solid stretches of a row.
void void_row(std::span<const Stretch> solid, int width, std::vector<Stretch>& stretches) {
    int at = 0;
    for (const Stretch& s : solid) {
        if (s.begin > at) stretches.push_back({static_cast<std::uint16_t>(at), s.begin, 0});
        at = s.end;
    }
    if (at < width) stretches.push_back({static_cast<std::uint16_t>(at), static_cast<std::uint16_t>(width), 0});
}

/// Calls `meet(i, j)` for stretches of two rows with a common column.
template <class Meet>
void overlaps_of_rows(const PieceMap& map, int upper, const Meet& meet) {
    std::uint32_t i = map.starts[upper], j = map.starts[upper + 1];
    const std::uint32_t i_end = map.starts[upper + 1], j_end = map.starts[upper + 2];
    while (i < i_end && j < j_end) {
        const Stretch &a = map.stretches[i], &b = map.stretches[j];
        if (a.begin < b.end && b.begin < a.end) meet(i, j);
        if (a.end < b.end) {
            ++i;
        } else {
            ++j;
        }
    }
}

/// Numbers the components by their first stretch. With `outside`, component 0 is everything connected to the image
/// borders or the first or last row.
void number_pieces(PieceMap& map, bool outside, int width) {
    const auto count = static_cast<std::uint32_t>(map.stretches.size());
    Sets sets(count + 1);  // stretch i has number i + 1; 0 is the outside
    for (int r = 0; r + 1 < map.rows(); ++r)
        overlaps_of_rows(map, r, [&](std::uint32_t i, std::uint32_t j) { sets.join(i + 1, j + 1); });
    if (outside && map.rows() > 0) {
        for (std::uint32_t i = 0; i < count; ++i) {
            const bool end_row = i < map.starts[1] || i >= map.starts[map.starts.size() - 2];
            if (end_row || map.stretches[i].begin == 0 || map.stretches[i].end == width) sets.join(0, i + 1);
        }
    }
    std::vector<std::uint32_t> number(count + 1, UINT32_MAX);
    std::uint32_t next = 0;
    if (outside) number[0] = next++;
    map.pixels.assign(next, 0);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t root = sets.root(i + 1);
        if (number[root] == UINT32_MAX) {
            number[root] = next++;
            map.pixels.push_back(0);
        }
        map.stretches[i].piece = number[root];
        map.pixels[number[root]] += map.stretches[i].end - map.stretches[i].begin;
    }
}

/// The first pixel of each component.
void first_pixels(const PieceMap& map, std::vector<int>& rows, std::vector<int>& columns) {
    rows.assign(map.pixels.size(), -1);
    columns = rows;
    for (int row = map.first_row; row < map.first_row + map.rows(); ++row) {
        for (const Stretch& s : map.row(row)) {
            if (rows[s.piece] >= 0) continue;
            rows[s.piece] = row;
            columns[s.piece] = s.begin;
        }
    }
}

}  // namespace

std::span<const Stretch> PieceMap::row(int row) const {
    const int r = row - first_row;
    if (r < 0 || r >= rows()) return {};
    return std::span(stretches).subspan(starts[r], starts[r + 1] - starts[r]);
}

PieceMap pieces_of(const RunSet& set) {
    PieceMap map;
    map.first_row = set.first_row();
    map.starts.push_back(0);
    for (int row = set.first_row(); row < set.end_row(); ++row) {
        for (const PixelSpan& span : set.row(row))
            map.stretches.push_back({static_cast<std::uint16_t>(span.begin), static_cast<std::uint16_t>(span.end), 0});
        map.starts.push_back(static_cast<std::uint32_t>(map.stretches.size()));
    }
    number_pieces(map, false, set.width_px());
    return map;
}

LayerShape shape_of(const ComposedLayer& layer, int width_px) {
    LayerShape shape;
    int first = INT32_MAX, end = 0;
    for (const MaterialImage& m : layer.images) {
        first = std::min(first, m.image.first_row());
        end = std::max(end, m.image.end_row());
    }
    if (first >= end) return shape;
    shape.solid.first_row = shape.voids.first_row = first;
    for (int row = first; row < end; ++row) {
        shape.solid.starts.push_back(static_cast<std::uint32_t>(shape.solid.stretches.size()));
        solid_row(layer, row, shape.solid.stretches);
    }
    shape.solid.starts.push_back(static_cast<std::uint32_t>(shape.solid.stretches.size()));
    for (int row = first; row < end; ++row) {
        shape.voids.starts.push_back(static_cast<std::uint32_t>(shape.voids.stretches.size()));
        void_row(shape.solid.row(row), width_px, shape.voids.stretches);
    }
    shape.voids.starts.push_back(static_cast<std::uint32_t>(shape.voids.stretches.size()));
    number_pieces(shape.solid, false, width_px);
    number_pieces(shape.voids, true, width_px);
    shape.faint = shape.solid.stretches.empty();
    first_pixels(shape.solid, shape.solid_row, shape.solid_column);
    first_pixels(shape.voids, shape.void_row, shape.void_column);
    return shape;
}

}  // namespace pliant::slice
