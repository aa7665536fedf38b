#include "presentation/print_report/wash_picture.hpp"

#include <doctest/doctest.h>

#include "presentation/draw/test_pixels.hpp"
#include "printing/wash/test_parts.hpp"

using namespace pliant;

namespace {

struct Reddest {
    int red = 0, pale = 0;
};

/// Pixels of the part's left or right view that are as red as what stays wet, and those as pale as what is clean.
Reddest count(std::string_view png, bool right) {
    const report::test::Pixels pixels = report::test::decode(png);
    REQUIRE(pixels.width == 1600);
    const auto* bytes = reinterpret_cast<const unsigned char*>(pixels.bytes.data());
    Reddest found;
    for (int y = 170; y < 800; ++y) {
        for (int x = right ? 800 : 0; x < (right ? 1600 : 800); ++x) {
            const unsigned char* p = bytes + y * pixels.stride + 4 * x;
            const bool grey = std::abs(p[2] - p[0]) < 40;
            if (p[2] > p[0] + 90) ++found.red;
            if (grey && p[2] < 245) ++found.pale;
        }
    }
    return found;
}

}  // namespace

TEST_CASE("wet faces are drawn red: the top of a plate on a stem, not the side towards the jets") {
    const wash::PartCells part = wash::test::cells_of(
        30, 20, 1, [](double x, double y, double d) { return d > 16 || (std::abs(x) < 4 && std::abs(y) < 4); });
    const std::vector<wash::Face> faces = wash::wet_faces(part);
    std::vector<double> rates;
    for (const wash::Face& face : faces) rates.push_back(face.middle.z < -19.9 ? 1 : 0);
    const wash::Cleanness c = wash::cleanness(faces, rates, 10);
    const Result<std::string> png = report::wash_picture("plate", part, faces, c);
    REQUIRE_MESSAGE(png, (png ? "" : png.error().message));
    const Reddest jets = count(*png, false), platform = count(*png, true);
    CHECK(jets.pale > 20000);
    CHECK(platform.red > 20000);
    CHECK(jets.pale > jets.red);
    CHECK(platform.red > 3 * platform.pale);
    CHECK_FALSE(report::wash_picture("nothing", {}, {}, {}));
}
