#include "printing/slice/run_set.hpp"

#include <doctest/doctest.h>

#include <random>

using namespace pliant::slice;

namespace {

constexpr int columns = 40, rows = 30;

Image random_image(unsigned seed, double share) {
    std::mt19937 random(seed);
    Image image{columns, rows, std::vector<std::uint8_t>(columns * rows)};
    for (auto& p : image.pixels) p = static_cast<double>(random() % 1000) < 1000 * share ? 255 : 0;
    return image;
}

RunSet set_of(const Image& image) {
    return RunSet::lit(RunImage::from_image(image));
}

bool has(const RunSet& set, int row, int column) {
    for (const PixelSpan& s : set.row(row)) {
        if (s.begin <= column && column < s.end) return true;
    }
    return false;
}

/// Whether there is a lit pixel within r of (row, column).
bool lit_within(const Image& image, int row, int column, int r) {
    for (int y = std::max(0, row - r); y <= std::min(rows - 1, row + r); ++y) {
        for (int x = std::max(0, column - r); x <= std::min(columns - 1, column + r); ++x) {
            const int dx = x - column, dy = y - row;
            if (image.at(y, x) > 0 && dx * dx + dy * dy <= r * r) return true;
        }
    }
    return false;
}

}  // namespace

TEST_CASE("set operations on runs agree with pixel by pixel ones") {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const Image a = random_image(seed, 0.4), b = random_image(seed + 100, 0.6), few = random_image(seed, 0.02);
        const RunSet sa = set_of(a), sb = set_of(b), sf = set_of(few);
        const RunSet both = united(sa, sb), shared = common(sa, sb), rest = without(sa, sb), other = complement(sa);
        const RunSet wide = grown(sf, 3), narrow = shrunk(complement(sf), 3), to_left = reaching(sf, {2, 0, 0, 1});
        bool same = true;
        for (int row = 0; row < rows; ++row) {
            for (int column = 0; column < columns; ++column) {
                const bool in_a = a.at(row, column) > 0, in_b = b.at(row, column) > 0;
                same &= has(both, row, column) == (in_a || in_b) && has(shared, row, column) == (in_a && in_b);
                same &= has(rest, row, column) == (in_a && !in_b) && has(other, row, column) == !in_a;
                same &= has(wide, row, column) == lit_within(few, row, column, 3);
                same &= has(narrow, row, column) == !lit_within(few, row, column, 3);
                bool reached = false;
                for (int y = row; y <= std::min(rows - 1, row + 1); ++y) {
                    for (int x = std::max(0, column - 2); x <= column; ++x) reached |= few.at(y, x) > 0;
                }
                same &= has(to_left, row, column) == reached;
            }
        }
        CHECK(same);
    }
}

TEST_CASE("a square grows with rounded corners, and shrinks back to itself") {
    RunSet square(columns, rows);
    for (int row = 10; row < 20; ++row) square.append_row(row, {{10, 20}});
    const RunSet wide = grown(square, 4);
    CHECK(wide.row(15).front() == PixelSpan{6, 24});
    CHECK(wide.first_row() == 6);
    CHECK(wide.end_row() == 24);
    CHECK(shrunk(square, 4).pixels() == 4);
    CHECK(shrunk(square, 5).empty());
    CHECK(shrunk(wide, 4).row(15).front() == PixelSpan{10, 20});
}
