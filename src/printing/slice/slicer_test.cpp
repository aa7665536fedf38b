#include "printing/slice/slicer.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "printing/slice/place.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

struct Shot {
    int layer, material;
    Image image;
};
struct Sliced {
    std::vector<Shot> shots;
    Summary summary;
};

Sliced slice_all(const std::vector<Body>& bodies, const Settings& settings) {
    Sliced sliced;
    Progress progress;
    auto summary = slice_bodies(
        bodies, settings,
        [&](int layer, int material, const RunImage& image) {
            sliced.shots.push_back({layer, material, image.to_image()});
            return Status{};
        },
        progress);
    REQUIRE_MESSAGE(summary.has_value(), (summary ? "" : summary.error().message));
    sliced.summary = *summary;
    return sliced;
}

Sliced slice_all(const std::vector<Body>& bodies) {
    return slice_all(bodies, {small_raster, 50, {}});
}

std::string refused(const std::vector<Body>& bodies, const Settings& settings) {
    Progress progress;
    const auto summary = slice_bodies(
        bodies, settings, [](int, int, const RunImage&) { return Status{}; }, progress);
    REQUIRE(!summary.has_value());
    return summary.error().message;
}

long value_sum(const Image& image) {
    long sum = 0;
    for (const auto p : image.pixels) sum += p;
    return sum;
}

/// Number of pixels lit by more than one image of a layer.
int shared_pixels(const Sliced& sliced, int layer) {
    std::vector<int> uses(static_cast<std::size_t>(small_raster.width_px * small_raster.height_px), 0);
    for (const Shot& s : sliced.shots) {
        if (s.layer != layer) continue;
        for (std::size_t i = 0; i < uses.size(); ++i) uses[i] += s.image.pixels[i] > 0;
    }
    return static_cast<int>(std::count_if(uses.begin(), uses.end(), [](int n) { return n > 1; }));
}

}  // namespace

TEST_CASE("a box lights exactly its pixels, however the image is mirrored") {
    const std::vector<Body> bodies{{"soft", box({-1000, 500, 0}, {2000, 1500, 200}), ""}};
    for (const bool mirror_x : {false, true}) {
        for (const bool mirror_y : {false, true}) {
            const Sliced s = slice_all(bodies, {{64, 48, 100, mirror_x, mirror_y}, 50, {}});
            CHECK(s.summary.layer_count == 4);
            REQUIRE(s.shots.size() == 4);
            for (const Shot& shot : s.shots) {
                CHECK(value_sum(shot.image) == 300 * 255);
                // x from -10 to 20 pixels of the centre, y from 5 to 15.
                CHECK(shot.image.at(mirror_y ? 24 + 5 : 24 - 6, mirror_x ? 32 + 9 : 32 - 10) == 255);
                CHECK(shot.image.at(mirror_y ? 24 + 14 : 24 - 15, mirror_x ? 32 - 20 : 32 + 19) == 255);
                CHECK(shot.image.at(mirror_y ? 24 + 4 : 24 - 5, mirror_x ? 32 + 9 : 32 - 10) == 0);
                CHECK(shot.image.at(mirror_y ? 24 + 14 : 24 - 15, mirror_x ? 32 - 21 : 32 + 20) == 0);
            }
            CHECK(s.summary.warnings.empty());
        }
    }
}

TEST_CASE("a rotated and shifted image shows the part rotated and shifted") {
    const std::vector<Body> bodies{{"soft", box({-1000, 500, 0}, {2000, 1500, 50}), ""}};
    Settings settings{small_raster, 50, {}};
    settings.raster.rotation_deg = 90;  // x becomes y: rows 20 up to 10 down, columns 15 to 5 left of the middle
    settings.raster.offset_x_um = 300;
    settings.raster.offset_y_um = -200;
    const Image image = slice_all(bodies, settings).shots.at(0).image;
    CHECK(value_sum(image) == 300 * 255);
    CHECK(int{image.at(24 - 20 + 2, 32 - 15 + 3)} == 255);
    CHECK(int{image.at(24 + 9 + 2, 32 - 6 + 3)} == 255);
    CHECK(int{image.at(24 - 21 + 2, 32 - 15 + 3)} == 0);
    CHECK(int{image.at(24 - 20 + 2, 32 - 16 + 3)} == 0);
    settings.raster.rotation_deg = 33;
    settings.raster.offset_x_um = settings.raster.offset_y_um = 0;
    CHECK(std::fabs(value_sum(slice_all(bodies, settings).shots.at(0).image) - 300 * 255) < 60);
    CHECK(refused(bodies, {{64, 48, 100, false, false, 0, 2000, 0}, 50, {}}).find("lies outside the image") !=
          std::string::npos);
    CHECK(refused(bodies, {{64, 48, 100, false, false, 0, 2000, 0}, 50, {}})
              .ends_with(
                  "whose corners are at (-5.200, 2.400), (1.200, 2.400), (1.200, -2.400) and (-5.200, -2.400) mm"));
    CHECK(refused(bodies, {{64, 48, 100, false, false, 400}, 50, {}}).find("turned by 400 degrees") !=
          std::string::npos);
}

TEST_CASE("a part that compensation moves over the image's border is refused") {
    const std::vector<Body> plate{{"soft", box({-3150, -2350, 0}, {3150, 2350, 200}), ""}};
    Settings settings{{64, 48, 100}, 50, {}};
    settings.compensation["soft"] = {50, 0, 0};
    CHECK(Slicer::prepare(plate, settings).has_value());
    settings.compensation["soft"] = {60, 0, 0};
    CHECK(refused(plate, settings).find("body 1 (soft), grown by its xy_compensation of 0.06 mm: x -3.150 to 3.150") ==
          0);
    settings.compensation["soft"] = {60, 60, 4};  // the last layer is moved by 45 um
    CHECK(Slicer::prepare(plate, settings).has_value());
}

TEST_CASE("an image turned by a quarter covers the platform upright: parts fit as they are drawn") {
    Settings settings{{64, 48, 100}, 50, {}};
    for (const double degrees : {90.0, -90.0, 270.0}) {
        settings.raster.rotation_deg = degrees;
        std::vector<Body> upright{{"soft", box({-1000, -3200, 0}, {1000, 3200, 50}), ""}};
        REQUIRE(place_on_platform(upright, settings.raster).has_value());
        CHECK(value_sum(slice_all(upright, settings).shots.at(0).image) == 20 * 64 * 255);
        std::vector<Body> lying{{"soft", box({-3200, -1000, 0}, {3200, 1000, 50}), ""}};
        CHECK(place_on_platform(lying, settings.raster).error().message ==
              "the part measures 6.400 x 2.000 mm, the image only 4.800 x 6.400 mm");
        CHECK(refused(lying, settings).find("the image, which reaches 2.400 mm in x and 3.200 mm in y") !=
              std::string::npos);
    }
}

TEST_CASE("grey values are the exact coverage") {
    // 10.25 x 10.5 pixels: a corner pixel of 1/8.
    const Sliced s = slice_all({{"soft", box({0, 0, 0}, {1025, 1050, 50}), ""}});
    const Image& image = s.shots.at(0).image;
    CHECK(int{image.at(23, 32)} == 255);
    CHECK(int{image.at(23, 42)} == 64);   // 255/4 = 63.75
    CHECK(int{image.at(13, 32)} == 128);  // 255/2 = 127.5
    CHECK(int{image.at(13, 42)} == 32);   // 255/8 = 31.9
}

TEST_CASE("without anti-aliasing the threshold decides which pixels are lit") {
    Settings settings{small_raster, 50, {false, 0.5, 20}};
    const std::vector<Body> bodies{{"soft", box({0, 0, 0}, {1025, 1050, 50}), ""}};
    CHECK(value_sum(slice_all(bodies, settings).shots.at(0).image) == 110 * 255);
    settings.rules.threshold = 0.51;
    CHECK(value_sum(slice_all(bodies, settings).shots.at(0).image) == 100 * 255);
    settings.rules.threshold = 0.1;
    CHECK(value_sum(slice_all(bodies, settings).shots.at(0).image) == 121 * 255);
}

TEST_CASE("two half cubes meet without gap or double pixel, wherever in a pixel their interface is") {
    for (const double x : {0.0, 12.5, 30.0, 50.0, 51.0, 99.0}) {
        const Sliced s = slice_all({{"soft", box({-1000, -1000, 0}, {x, 1000, 100}), ""},
                                    {"rigid", box({x, -1000, 0}, {1000, 1000, 100}), ""}});
        CHECK(s.summary.materials == std::vector<std::string>{"soft", "rigid"});
        REQUIRE(s.shots.size() == 4);
        CHECK(shared_pixels(s, 0) == 0);
        const long soft = value_sum(s.shots[0].image), rigid = value_sum(s.shots[1].image);
        CHECK(soft + rigid == 400 * 255);
        CHECK(soft == (x > 50 ? 11 : 10) * 20 * 255);  // a tie goes to the later body
        CHECK(s.summary.overlap_mm3 == 0);
        CHECK(s.summary.warnings.empty());
    }
}

TEST_CASE("at a slanted interface every pixel is full and in one image only") {
    const std::vector<Point2> left{{-1000, -1000}, {-300, -1000}, {400, 1000}, {-1000, 1000}};
    const std::vector<Point2> right{{-300, -1000}, {1000, -1000}, {1000, 1000}, {400, 1000}};
    const Sliced s = slice_all({{"soft", prism(left, 0, 50), ""}, {"rigid", prism(right, 0, 50), ""}});
    CHECK(shared_pixels(s, 0) == 0);
    REQUIRE(s.shots.size() == 2);
    CHECK(value_sum(s.shots[0].image) + value_sum(s.shots[1].image) == 400 * 255);
}

TEST_CASE("an overlap goes to the later body and is reported") {
    const std::vector<Body> bodies{{"soft", box({-1000, -500, 0}, {500, 500, 500}), "left"},
                                   {"rigid", box({-500, -500, 0}, {1000, 500, 500}), ""}};
    const Sliced s = slice_all(bodies);
    CHECK(s.summary.overlap_mm3 == near(0.5, {.relative = 1e-12}));
    REQUIRE(s.summary.warnings.size() == 1);
    CHECK(s.summary.warnings[0] ==
          "body 'left' (soft): 0.5 mm^3 overlap with later bodies of other materials, which keep them");
    CHECK(value_sum(s.shots[0].image) == 50 * 255);
    CHECK(value_sum(s.shots[1].image) == 150 * 255);
    CHECK(shared_pixels(s, 0) == 0);
}

TEST_CASE("bodies of one material may overlap") {
    const Sliced s = slice_all(
        {{"soft", box({-1000, -500, 0}, {500, 500, 50}), ""}, {"soft", box({-500, -500, 0}, {1000, 500, 50}), ""}});
    CHECK(s.summary.overlap_mm3 == 0);
    CHECK(s.summary.warnings.empty());
    CHECK(value_sum(s.shots.at(0).image) == 200 * 255);
}

TEST_CASE("a later body inside an earlier one replaces it, but a small share of a pixel does not") {
    const Sliced s = slice_all(
        {{"soft", box({-1000, -1000, 0}, {1000, 1000, 50}), ""}, {"rigid", box({-240, -200, 0}, {260, 200, 50}), ""}});
    CHECK(shared_pixels(s, 0) == 0);
    CHECK(value_sum(s.shots[0].image) + value_sum(s.shots[1].image) == 400 * 255);
    CHECK(value_sum(s.shots[1].image) == 5 * 4 * 255);  // columns -2 to 2: 40 % of the left pixel, 60 % of the right
    CHECK(s.summary.overlap_mm3 == near(0.5 * 0.4 * 0.05, {.relative = 1e-9}));
}

TEST_CASE("gaps much narrower than a pixel between materials leave no dark line") {
    for (const double x : {0.0, 45.0, 93.0, 95.0}) {
        const std::vector<Body> bodies{{"soft", box({-1000, -1000, 0}, {x, 1000, 50}), ""},
                                       {"rigid", box({x + 10, -1000, 0}, {1000, 1000, 50}), ""}};
        const Sliced s = slice_all(bodies);
        CHECK(value_sum(s.shots[0].image) + value_sum(s.shots[1].image) == 400 * 255);
        CHECK(s.summary.closed_gap_pixels == (x == 93 || x == 95 ? 40 : 20));
        CHECK(s.summary.warnings.size() == 1);
        Settings keep{small_raster, 50, {}};
        keep.rules.close_gap_um = 0;
        const Sliced kept = slice_all(bodies, keep);
        CHECK(value_sum(kept.shots[0].image) + value_sum(kept.shots[1].image) < 399 * 255);
    }
}

TEST_CASE("outer borders do not count as gaps") {
    // Both materials end 10 um before a pixel's border, at the top and at the sides.
    const Sliced s = slice_all(
        {{"soft", box({-990, -1000, 0}, {0, 990, 50}), ""}, {"rigid", box({0, -1000, 0}, {990, 990, 50}), ""}});
    CHECK(s.summary.closed_gap_pixels == 0);
}

TEST_CASE("shells: a cavity, two overlapping shells, touching shells, inverted shells") {
    const auto first = [](const mesh::TriMesh& mesh, int layer) {
        const Sliced s = slice_all({{"soft", mesh, ""}});
        return value_sum(s.shots.at(layer).image);
    };
    const mesh::TriMesh cube = box({-1000, -1000, 0}, {1000, 1000, 500});
    const mesh::TriMesh inner = box({-600, -600, 100}, {600, 600, 400});
    const mesh::TriMesh hollow = together(cube, turned_inside_out(inner));
    CHECK(first(hollow, 0) == 400 * 255);
    CHECK(first(hollow, 5) == (400 - 144) * 255);
    CHECK(first(turned_inside_out(hollow), 5) == (400 - 144) * 255);
    CHECK(first(together(cube, inner), 5) == 400 * 255);
    CHECK(first(together(cube, box({550, -1000, 0}, {1500, 1000, 500})), 5) == 500 * 255);
    CHECK(first(together(cube, box({1000, -1000, 0}, {1500, 1000, 500})), 5) == 500 * 255);
    CHECK(first(together(box({-1000, -1000, 0}, {30, 1000, 500}), box({30, -1000, 0}, {1000, 1000, 500})), 5) ==
          400 * 255);
}

TEST_CASE("a face on a layer plane or in the middle of a layer is in exactly one layer") {
    for (const double z : {50.0, 25.0, 75.0, 60.0}) {
        const Sliced s = slice_all({{"soft", box({-1000, -1000, 0}, {1000, 1000, 25}), ""},
                                    {"rigid", box({-1000, -1000, z}, {1000, 1000, z + 50}), ""}});
        int rigid_layers = 0;
        for (const Shot& shot : s.shots) {
            if (shot.material == 1) {
                ++rigid_layers;
                CHECK(value_sum(shot.image) == 400 * 255);
            }
        }
        CHECK(rigid_layers == 1);
    }
}

TEST_CASE("a stack of bodies fills every layer once, whatever their heights") {
    std::vector<Body> bodies;
    const std::vector<double> heights{0, 25, 110, 125, 333.3, 500};
    for (std::size_t i = 0; i + 1 < heights.size(); ++i)
        bodies.push_back({fmt::format("m{}", i), box({-500, -500, heights[i]}, {500, 500, heights[i + 1]}), ""});
    const Sliced s = slice_all(bodies);
    REQUIRE(s.shots.size() == 10);
    for (int k = 0; k < 10; ++k) CHECK(s.shots[k].layer == k);
}

TEST_CASE("a cone's layers have the area of its section at mid height") {
    // Apex above a 97-gon of radius 2000: area at height z is the base's times (1 - z/h)^2.
    const int corners = 97;
    const auto base = regular_polygon(corners, 2000);
    mesh::TriMesh cone;
    for (int i = 0; i < corners; ++i) {
        const Point2 p = base[i], q = base[(i + 1) % corners];
        add_triangle(cone, {0, 0, 0}, {q.x, q.y, 0}, {p.x, p.y, 0});
        add_triangle(cone, {p.x, p.y, 0}, {q.x, q.y, 0}, {0, 0, 1000});
    }
    const Sliced s = slice_all({{"soft", cone, ""}});
    REQUIRE(s.shots.size() == 20);
    const double base_px = 0.5 * corners * 400 * std::sin(2 * std::numbers::pi / corners);
    for (const Shot& shot : s.shots) {
        const double z = (shot.layer + 0.5) / 20;
        // Each of the border pixels, 6 times the radius of 20 pixels at most, is rounded to 1/255.
        CHECK(std::fabs(value_sum(shot.image) / 255.0 - base_px * (1 - z) * (1 - z)) < 0.05);
    }
}

TEST_CASE("parts outside the image, below the platform or without solid surface are refused with numbers") {
    const Settings settings{small_raster, 50, {}};
    const Body cube{"soft", box({-1000, -1000, 0}, {1000, 1000, 500}), "cube"};
    CHECK(refused({{"soft", box({-1000, -1000, 0}, {4000, 1000, 500}), ""}}, settings).find("x -1.000 to 4.000 mm") !=
          std::string::npos);
    CHECK(refused({{"soft", box({-1000, -1000, -100}, {1000, 1000, 500}), ""}}, settings) ==
          "body 1 (soft): reaches 0.100 mm below the platform");
    CHECK(refused({}, settings).find("nothing to print") == 0);
    CHECK(refused({{"soft", box({0, 0, 0}, {1000, 1000, 20}), ""}}, settings) ==
          "nothing to print: no body reaches the middle of a layer of 50 um; the part measures 1 x 1 x 0.02 mm, is its "
          "unit right?");
    CHECK(refused({cube}, {{0, 48, 100}, 50, {}}).find("raster of 0 x 48") == 0);
    CHECK(refused({cube}, {{60000, 60000, 100}, 50, {}}).find("2^28") != std::string::npos);
    CHECK(refused({cube}, {{64, 48, std::nan("")}, 50, {}}).find("pixel of nan") == 0);
    CHECK(refused({cube}, {small_raster, 0, {}}).find("layer of 0 um") == 0);
    CHECK(refused({cube}, {small_raster, 50, {true, 0, 20}}).find("threshold 0") == 0);
}

TEST_CASE("bodies too small to be lit, and floating parts, are reported") {
    const Sliced s = slice_all({{"soft", box({-1000, -1000, 0}, {1000, 1000, 100}), ""},
                                {"speck", box({0, 0, 30}, {1, 1, 31}), ""},
                                {"hair", box({1500, 0, 0}, {1501, 1000, 100}), ""},
                                {"cloud", box({-1000, -1000, 200}, {1000, 1000, 300}), ""}});
    REQUIRE(s.summary.warnings.size() == 3);
    CHECK(s.summary.warnings[0].find("body 2 (speck)") == 0);
    CHECK(s.summary.warnings[1].find("body 3 (hair)") == 0);
    CHECK(s.summary.warnings[2].find("2 empty layers between printed ones, the first is layer 3") == 0);
}

TEST_CASE("an error of emit, or cancellation, stops slicing") {
    const std::vector<Body> bodies{{"soft", box({-1000, -1000, 0}, {1000, 1000, 500}), ""}};
    Progress progress;
    const auto stopped = slice_bodies(
        bodies, {small_raster, 50, {}},
        [](int layer, int, const RunImage&) -> Status { return failure("stop at {}", layer); }, progress);
    CHECK(stopped.error().message == "stop at 0");
    struct Cancel : Progress {
        [[nodiscard]] bool cancelled() const override { return true; }
    } cancel;
    CHECK(slice_bodies(
              bodies, {small_raster, 50, {}}, [](int, int, const RunImage&) { return Status{}; }, cancel)
              .error()
              .cause == Cause::cancelled);
}

TEST_CASE("random triangle soups are refused, or printed inside their bounding box") {
    std::uint32_t state = 7;
    const auto random = [&](int n) {
        state = state * 1664525 + 1013904223;
        return static_cast<int>((state >> 8) % static_cast<std::uint32_t>(n));
    };
    int printed = 0;
    for (int round = 0; round < 300; ++round) {
        mesh::TriMesh tangle = box({-500, -500, 0}, {500, 500, 400});
        for (int i = random(4); i > 0; --i) tangle.triangles.erase(tangle.triangles.begin() + random(8));
        for (int i = 0; i < 6; ++i)
            tangle.points.push_back({random(1000) - 500.0, random(1000) - 500.0, random(400) * 1.0});
        const int points = static_cast<int>(tangle.points.size());
        for (int i = random(8); i > 0; --i)
            tangle.triangles.push_back({random(points), random(points), random(points)});
        const auto slicer = Slicer::prepare(std::vector<Body>{{"soft", tangle, ""}}, {small_raster, 50, {}});
        if (!slicer) continue;
        ++printed;
        for (int k = 0; k < slicer->layer_count(); ++k) {
            for (const MaterialImage& m : slicer->layer(k).images) {
                long inside = 0;
                for (int row = 24 - 5; row < 24 + 5; ++row) {
                    for (int column = 32 - 5; column < 32 + 5; ++column) inside += m.image.at(row, column);
                }
                CHECK(inside == m.value_sum);
            }
        }
    }
    CHECK(printed > 30);
}

TEST_CASE("a part is centred and put on the platform; one that is too large is refused") {
    std::vector<Body> bodies{{"soft", box({5000, 6000, 7000}, {6000, 8000, 7100}), ""},
                             {"rigid", box({6000, 6000, 7000}, {7000, 8000, 7200}), ""}};
    const auto warnings = place_on_platform(bodies, small_raster);
    REQUIRE(warnings.has_value());
    CHECK(warnings->empty());
    const Box3 left = mesh::bounds(bodies[0].surface_um), right = mesh::bounds(bodies[1].surface_um);
    CHECK(left.low == Vec3{-1000, -1000, 0});
    CHECK(left.high == Vec3{0, 1000, 100});
    CHECK(right.high == Vec3{1000, 1000, 200});

    std::vector<Body> large{{"soft", box({0, 0, 0}, {6500, 1000, 100}), ""}};
    const auto refused_part = place_on_platform(large, small_raster);
    REQUIRE(!refused_part.has_value());
    CHECK(refused_part.error().message == "the part measures 6.500 x 1.000 mm, the image only 6.400 x 4.800 mm");

    std::vector<Body> far{{"soft", box({1e9, 0, 0}, {1e9 + 1000, 1000, 100}), ""}};
    CHECK(place_on_platform(far, small_raster)->size() == 1);
    std::vector<Body> none;
    CHECK(!place_on_platform(none, small_raster).has_value());
    far[0].surface_um.points[1].z = HUGE_VAL;
    CHECK(!place_on_platform(far, small_raster).has_value());
}
