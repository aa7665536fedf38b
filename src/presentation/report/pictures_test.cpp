#include "presentation/report/pictures.hpp"

#include <cairo.h>
#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "base/core/near.hpp"
#include "presentation/draw/canvas.hpp"
#include "presentation/draw/raycast.hpp"
#include "presentation/report/test_robot.hpp"

using namespace pliant;
using namespace pliant::report;

namespace {

constexpr int width = 160, height = 100;

struct Stage {
    report::test::Robot robot = report::test::bent_bar(4, 2);
    std::vector<int> materials = {0, 0};
    Surface surface = outer_surface(robot.mesh, materials);
    Scene scene;
    Camera camera;

    Stage() {
        scene.surface = &surface;
        scene.body = pose(surface, robot.result.steps.back().positions);
        scene.vertex_colours.assign(surface.vertex_node.size(), Colour{0.9, 0.1, 0.1});
        const std::vector<Vec3> rest = pose(surface, robot.mesh.points).positions;
        const std::vector<std::span<const Vec3>> moved = {scene.body.positions};
        camera = fitted(choose_view(rest, moved), scene.body.positions, 1.6, {0.1, 0.1, 0.1, 0.1});
    }
    /// Moves the camera so that these points are in the picture too.
    void see(std::vector<Vec3> points) {
        points.insert(points.end(), scene.body.positions.begin(), scene.body.positions.end());
        camera = fitted(camera, points, 1.6, {0.1, 0.1, 0.1, 0.1});
    }
    [[nodiscard]] Image image() const {
        auto image = render(scene, camera, width, height, Progress());
        REQUIRE(image.has_value());
        return *image;
    }
    /// Where a point of the body is seen, as an index into rgb.
    [[nodiscard]] std::size_t pixel(const Vec3& point) const {
        const auto [u, v, depth] = camera.project(point);
        const auto x = static_cast<std::size_t>((u + 1) / 2 * width),
                   y = static_cast<std::size_t>((1 - v) / 2 * height);
        return 3 * (y * width + x);
    }
};

int brightness(const Image& image, std::size_t at) {
    return image.rgb[at] + image.rgb[at + 1] + image.rgb[at + 2];
}

}  // namespace

TEST_CASE("the body is drawn in its colour on a light background") {
    const Stage stage;
    const Image image = stage.image();
    REQUIRE(image.rgb.size() == 3 * width * height);
    CHECK(brightness(image, 0) > 3 * 235);
    const std::size_t middle = stage.pixel(stage.robot.result.steps.back().markers[1].position_m);
    CHECK(image.rgb[middle] > 110);
    CHECK(image.rgb[middle] > 2 * image.rgb[middle + 1]);
    CHECK(image.rgb[middle] > 2 * image.rgb[middle + 2]);
}

TEST_CASE("a picture has the same bytes on one thread and on many") {
    const Stage stage;
    const Image many = stage.image();
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    CHECK(stage.image().rgb == many.rgb);
}

TEST_CASE("the body darkens the floor under it") {
    Stage stage;
    stage.scene.floor_z_m = 0;
    const Vec3 contact{0.02, -0.001, 0}, aside{0.05, -0.05, 0};
    stage.see({contact, aside});
    const Image image = stage.image();
    CHECK(brightness(image, stage.pixel(contact)) < brightness(image, stage.pixel(aside)) - 20);
}

TEST_CASE("a cable is visible through the body, and a ghost over the background") {
    Stage stage;
    stage.scene.vertex_colours.assign(stage.surface.vertex_node.size(), Colour{0.1, 0.1, 0.9});
    const Pose rest = pose(stage.surface, stage.robot.mesh.points);
    stage.see(rest.positions);
    const Image plain = stage.image();
    stage.scene.cables = {{stage.robot.cable_points.back()[0]}};
    stage.scene.cable_radius_m = 0.002;
    stage.scene.ghost = rest;
    const Image full = stage.image();
    const std::size_t on_cable = stage.pixel(stage.robot.cable_points.back()[0][4]);
    CHECK(full.rgb[on_cable] > plain.rgb[on_cable] + 40);
    CHECK(full.rgb[on_cable + 2] > 25);
    const std::size_t on_ghost = stage.pixel({0.099, 0.001, 0.0075});
    CHECK(brightness(full, on_ghost) < brightness(plain, on_ghost) - 20);
    CHECK(brightness(full, on_ghost) > 3 * 120);
}

TEST_CASE("an obstacle hides the body, is grey and throws a shadow; a plane is visible from its front only") {
    Stage stage;
    const Vec3 eye = stage.camera.eye, aim = stage.robot.result.steps.back().markers[1].position_m;
    const Vec3 towards = (eye - aim) / norm(eye - aim);
    const mesh::TriMesh front = disc(aim + 0.05 * towards, towards, 0.01),
                        back = disc(aim + 0.05 * towards, -towards, 0.01);
    const auto seen = [&](const mesh::TriMesh& mesh, bool open) {
        const Surface surface = rigid_surface(mesh);
        stage.scene.things = {
            {&surface, pose(surface, mesh.points), std::vector<double>(surface.vertex_node.size(), 1.0), open}};
        return stage.image();
    };
    const std::size_t at = stage.pixel(aim);
    const Image plain = stage.image(), shown = seen(front, true), hidden = seen(back, true);
    CHECK(std::abs(shown.rgb[at] - shown.rgb[at + 2]) < 25);
    CHECK(shown.rgb[at] > 100);
    CHECK(hidden.rgb == plain.rgb);
    stage.scene.floor_z_m = -0.03;
    const mesh::TriMesh roof = disc({0.02, 0, 0.05}, {0, 0, 1}, 0.03);
    const Image lit = seen(roof, true), shaded = seen(roof, false);
    const std::size_t below = stage.pixel({0.0197, 0, 0.0106});
    CHECK(brightness(shaded, below) < brightness(lit, below) - 20);
}

namespace {

/// 0xAARRGGBB, row by row.
std::vector<std::uint32_t> pixels_of(const std::string& png) {
    std::pair<const std::string*, std::size_t> source{&png, 0};
    const auto read = [](void* from, unsigned char* to, unsigned length) {
        auto& [bytes, at] = *static_cast<std::pair<const std::string*, std::size_t>*>(from);
        if (at + length > bytes->size()) return CAIRO_STATUS_READ_ERROR;
        std::memcpy(to, bytes->data() + at, length);
        at += length;
        return CAIRO_STATUS_SUCCESS;
    };
    cairo_surface_t* image = cairo_image_surface_create_from_png_stream(read, &source);
    REQUIRE(cairo_surface_status(image) == CAIRO_STATUS_SUCCESS);
    const auto* first = reinterpret_cast<const std::uint32_t*>(cairo_image_surface_get_data(image));
    const std::vector<std::uint32_t> pixels(
        first, first + cairo_image_surface_get_width(image) * cairo_image_surface_get_height(image));
    cairo_surface_destroy(image);
    return pixels;
}

/// How many pixels are of nearly this colour.
int count_of(const std::vector<std::uint32_t>& pixels, const Colour& colour) {
    return static_cast<int>(std::count_if(pixels.begin(), pixels.end(), [&](std::uint32_t p) {
        const double most =
            std::max({std::abs(((p >> 16) & 255) / 255.0 - colour.r), std::abs(((p >> 8) & 255) / 255.0 - colour.g),
                      std::abs((p & 255) / 255.0 - colour.b)});
        return most < 0.08;
    }));
}

}  // namespace

TEST_CASE("the pictures are PNG files, not empty, and the same each time") {
    const auto robot = report::test::bent_bar(4, 1);
    const Simulation s = robot.simulation();
    const Surface surface = outer_surface(s.mesh, s.region_material);
    Progress progress;
    const auto pictures = draw_pictures(s, surface, {PictureSet::all, {240, 150}}, progress);
    const auto again = draw_pictures(s, surface, {PictureSet::all, {240, 150}}, progress);
    REQUIRE(pictures.has_value());
    REQUIRE(again.has_value());
    REQUIRE(pictures->size() == 4);
    const std::vector<std::string> names = {"rest.png", "final.png", "stages.png", "von_mises.png"};
    for (std::size_t i = 0; i < 4; ++i) {
        const Picture& picture = (*pictures)[i];
        CHECK(picture.file == names[i]);
        CHECK(picture.png == (*again)[i].png);
        const auto pixels = pixels_of(picture.png);
        REQUIRE(pixels.size() == 240 * 150);
        CHECK(std::set<std::uint32_t>(pixels.begin(), pixels.end()).size() > 500);
    }
}

TEST_CASE("elements of voids are drawn as faces with edges, measured points as rings; the markers have a plot") {
    const auto robot = report::test::bent_bar(4, 1);
    Simulation s = robot.simulation();
    const auto drawn = [&] {
        Progress progress;
        auto pictures =
            draw_pictures(s, outer_surface(s.mesh, s.region_material), {PictureSet::few, {480, 300}}, progress);
        REQUIRE(pictures.has_value());
        return *pictures;
    };
    const auto plain = pixels_of(drawn().front().png);
    CHECK(count_of(plain, element_colour) == 0);
    CHECK(count_of(plain, measured_colour) == 0);
    s.region_actuates.assign(s.mesh.region_names.size(), false);
    s.region_actuates.back() = true;
    CHECK(count_of(plain, element_edge_colour) == 0);
    CHECK(count_of(pixels_of(drawn().front().png), element_edge_colour) > 100);
    s.region_actuates.clear();
    s.measured = {{"tip", {s.result.steps.back().markers.front().position_m + Vec3{0, 0, 0.02}}}};
    const auto pictures = drawn();
    REQUIRE(pictures.size() == 2);
    CHECK(pictures[1].file == "measured.png");
    CHECK(count_of(pixels_of(pictures[0].png), measured_colour) > 20);
}

TEST_CASE("elements of voids are drawn in every stage, at the body's position") {
    const auto robot = report::test::bent_bar(4, 1);
    Simulation s = robot.simulation();
    const auto stages = [&] {
        Progress progress;
        const auto pictures =
            draw_pictures(s, outer_surface(s.mesh, s.region_material), {PictureSet::all, {800, 500}}, progress);
        REQUIRE(pictures.has_value());
        return pixels_of(pictures->at(2).png);
    };
    const auto plain = stages();
    s.region_actuates.assign(s.mesh.region_names.size(), true);
    const auto with = stages();
    // Four panels, two by two: in each of them the robot changes, and what is beside it does not.
    for (const int right : {0, 1}) {
        for (const int below : {0, 1}) {
            int changed = 0;
            for (int y = 60 + below * 220; y < 60 + below * 220 + 220; ++y) {
                for (int x = right * 400; x < right * 400 + 400; ++x) {
                    const auto at = static_cast<std::size_t>(y * 800 + x);
                    changed += plain[at] != with[at] ? 1 : 0;
                }
            }
            CHECK(changed > 300);
            CHECK(changed < 400 * 220 / 2);
        }
    }
}

TEST_CASE("the direction of view of a picture can be chosen") {
    const auto robot = report::test::bent_bar(4, 1);
    const Simulation s = robot.simulation();
    const Surface surface = outer_surface(s.mesh, s.region_material);
    Progress progress;
    PictureChoice choice{PictureSet::few, {240, 150}};
    const auto chosen = draw_pictures(s, surface, choice, progress);
    choice.towards_eye = Vec3{0, 0, 1};
    const auto above = draw_pictures(s, surface, choice, progress);
    REQUIRE(above.has_value());
    CHECK(above->front().png != chosen->front().png);
}

TEST_CASE("drawing a picture can be cancelled") {
    struct Stop : Progress {
        [[nodiscard]] bool cancelled() const override { return true; }
    };
    const Stage stage;
    const auto image = render(stage.scene, stage.camera, width, height, Stop());
    REQUIRE_FALSE(image.has_value());
    CHECK(image.error().cause == Cause::cancelled);
}

TEST_CASE("captions, and rounding up to nice numbers") {
    const auto robot = report::test::bent_bar(10, 1);
    CHECK(step_line(robot.simulation(), 5) == "step 5 of 10 · flexor 96.7 %, 35.5 N");
    auto rounded = report::test::bent_bar(10, 1);
    rounded.result.steps[5].cables[0].tension_N = 2.84e-14;
    CHECK(step_line(rounded.simulation(), 5) == "step 5 of 10 · flexor 96.7 %, 0 N");

    CHECK(nice_ceiling(557) == near(600, {.relative = 1e-12}));
    CHECK(nice_ceiling(600) == near(600, {.relative = 1e-12}));
    CHECK(nice_ceiling(0.081) == near(0.1, {.relative = 1e-12}));
    CHECK(nice_ceiling(0) == 1);
    CHECK(nice_ceiling(-4) == 1);
}

TEST_CASE("invalid UTF-8 and control characters are replaced") {
    CHECK(printable("ok \xc3\xa9\n") == "ok \xc3\xa9 ");
    CHECK(printable("\xc0\xaf") == "\xef\xbf\xbd\xef\xbf\xbd");                  // overlong
    CHECK(printable("\xed\xa0\x80") == "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");  // a surrogate
    CHECK(printable("\xe2\x82") == "\xef\xbf\xbd\xef\xbf\xbd");                  // cut short
}
