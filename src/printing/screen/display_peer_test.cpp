// The projector on a display: an X server without a screen (Xvfb), and what it really shows.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <thread>

#include "printing/host/projector_patterns.hpp"
#include "printing/job/job.hpp"
#include "printing/screen/projector.hpp"
#include "printing/screen/test_waiting.hpp"

// After our headers: it defines Status and other words as macros.
#include <X11/Xlib.h>
#include <X11/Xutil.h>
// Words of ours, in this file and in those that are compiled together with it.
#undef Always
#undef Bool
#undef None
#undef Status
#undef Success

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::host;
using pliant::host::test::becomes_true;

namespace {

constexpr int width_px = 320;
constexpr int height_px = 200;

/// An X server with two screens with a white background: anything black is ours.
class Server {
public:
    Server() {
        std::array<int, 2> ends{};
        if (::pipe(ends.data()) != 0) return;
        process_ = ::fork();
        if (process_ == 0) {
            ::close(ends[0]);
            const int null = ::open("/dev/null", O_WRONLY);
            ::dup2(null, STDERR_FILENO);
            const std::string file = std::to_string(ends[1]);
            ::execlp("Xvfb", "Xvfb", "-displayfd", file.c_str(), "-nolisten", "tcp", "-screen", "0", "320x200x24",
                     "-screen", "1", "160x120x24", static_cast<char*>(nullptr));
            ::_exit(127);
        }
        ::close(ends[1]);
        std::string number;
        for (char c = 0; c != '\n' && ::read(ends[0], &c, 1) == 1;) number += c;
        ::close(ends[0]);
        if (number.empty()) return;
        name_ = ":" + std::to_string(std::atoi(number.c_str()));
        ::setenv("DISPLAY", name_.c_str(), 1);
        display_ = ::XOpenDisplay(name_.c_str());
        if (display_ == nullptr) return;
        for (int screen = 0; screen < 2; ++screen) {
            ::XSetWindowBackground(display_, RootWindow(display_, screen), WhitePixel(display_, screen));
            ::XClearWindow(display_, RootWindow(display_, screen));
        }
        ::XSync(display_, False);
    }
    ~Server() {
        if (display_ != nullptr) ::XCloseDisplay(display_);
        if (process_ > 0) {
            ::kill(process_, SIGTERM);
            ::waitpid(process_, nullptr, 0);
        }
    }
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    [[nodiscard]] bool runs() const { return display_ != nullptr; }

    /// The content of the screen; coloured pixels count as 1.
    [[nodiscard]] job::Image screenshot(int screen = 0) const {
        ::XSync(display_, False);
        const int width = DisplayWidth(display_, screen);
        const int height = DisplayHeight(display_, screen);
        XImage* raw = ::XGetImage(display_, RootWindow(display_, screen), 0, 0, static_cast<unsigned>(width),
                                  static_cast<unsigned>(height), AllPlanes, ZPixmap);
        REQUIRE(raw != nullptr);
        job::Image image{width, height, {}};
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const unsigned long colour = XGetPixel(raw, x, y) & 0xffffffUL;
                const unsigned long grey = colour & 0xffUL;
                image.pixels.push_back(colour == grey * 0x010101UL ? static_cast<std::uint8_t>(grey) : std::uint8_t{1});
            }
        }
        XDestroyImage(raw);
        return image;
    }
    [[nodiscard]] bool all(std::uint8_t value, int screen = 0) const {
        const job::Image image = screenshot(screen);
        return std::all_of(image.pixels.begin(), image.pixels.end(), [&](std::uint8_t p) { return p == value; });
    }

private:
    pid_t process_ = -1;
    std::string name_;
    ::Display* display_ = nullptr;
};

/// Releases the displays at the end, so that no process remains.
struct Session {
    Server server;
    ~Session() {
        (void)release_display(0);
        (void)release_display(1);
    }
};

bool cannot_start(const Session& session) {
    if (session.server.runs()) return false;
    const char* no_skips = std::getenv("PLIANT_NO_SKIPS");
    const bool fails = no_skips != nullptr && *no_skips != '\0';
    CHECK_MESSAGE(!fails, "PLIANT_NO_SKIPS is set, and Xvfb does not start here");
    if (!fails) MESSAGE("not tested: Xvfb does not start here");
    return true;
}

ScreenOptions display_options(int width = width_px, int height = height_px) {
    return {width, height, 3600, PLIANT_SCREEN_PROGRAM};
}

/// A job with two materials on each layer, written and read as a real one.
job::Archive make_job(const std::filesystem::path& path) {
    job::Manifest manifest;
    manifest.name = "light";
    manifest.width_px = width_px;
    manifest.height_px = height_px;
    manifest.pixel_um = 100;
    manifest.materials = {{"soft", "a", 1, 1, 1, 1}, {"firm", "b", 1, 1, 1, 1}};
    auto writer = job::Writer::create(path).value();
    for (int layer = 0; layer < 3; ++layer) {
        job::Layer& l = manifest.layers.emplace_back(job::Layer{50 * (layer + 1), 50, {}});
        for (int material = 0; material < 2; ++material) {
            const std::string file = job::image_file_name(layer, manifest.materials[material].name);
            job::Image image{width_px, height_px, std::vector<std::uint8_t>(width_px * height_px)};
            for (std::size_t i = 0; i < image.pixels.size(); ++i)
                image.pixels[i] =
                    static_cast<std::uint8_t>(i * static_cast<std::size_t>(31 + 7 * layer + material) >> 3);
            l.images.push_back({material, file, 1});
            REQUIRE(writer.add_image(file, image));
        }
    }
    REQUIRE(writer.finish(manifest));
    return job::Archive::open(path).value();
}

}  // namespace

TEST_CASE("the display shows a job's images pixel by pixel, and black before, between and after") {
    Session session;
    if (cannot_start(session)) return;
    const Server& x = session.server;
    CHECK(x.all(255));
    const pliant::test::Folder folder("light");
    const job::Archive job = make_job(folder / "light.zip");
    {
        auto projector = ScreenProjector::open("0", display_options());
        REQUIRE_MESSAGE(projector, (projector ? "" : projector.error().message));
        CHECK(projector->panel().width_px == width_px);
        CHECK(projector->panel().refresh_hz == near(60, {.relative = 1e-12}));
        CHECK(becomes_true([&] { return x.all(0); }));
        for (const job::Layer& layer : job.manifest().layers) {
            for (const job::LayerImage& file : layer.images) {
                const job::Image image = job.image(file.file).value();
                REQUIRE(projector->show_for(image, 600));
                CHECK(becomes_true([&] { return x.screenshot() == image; }));
                REQUIRE(projector->black());
                CHECK(becomes_true([&] { return x.all(0); }));
            }
        }
    }
    // The host has ended normally: what is below the window stays hidden.
    for (int i = 0; i < 20; ++i) {
        CHECK(x.all(0));
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    CHECK(release_display(0).value());
    CHECK(becomes_true([&] { return x.all(255); }));
    CHECK_FALSE(release_display(0).value());
}

TEST_CASE("an exposure ends by itself and lasts the time asked for, to one frame of 60 Hz") {
    Session session;
    if (cannot_start(session)) return;
    const job::Image white = test_pattern("white", {width_px, height_px, 0, 1, 5, 3}).value();
    auto projector = ScreenProjector::open("0", display_options());
    REQUIRE(projector);
    for (const double seconds : {0.05, 0.1, 0.25, 0.5, 1.0}) {
        REQUIRE(projector->show_for(white, seconds));
        const auto light = projector->finish();
        CHECK(becomes_true([&] { return session.server.all(0); }));
        REQUIRE(light);
        REQUIRE(*light);
        CAPTURE(seconds);
        CAPTURE((*light)->frames);
        CAPTURE((*light)->longest_frame_s);
        // To half a frame; longer only by the delay of the last two frames on a busy machine.
        CHECK((*light)->on_s >= seconds - 0.5 / 60 - 1e-9);
        CHECK((*light)->on_s <= seconds - 1.5 / 60 + 2 * (*light)->longest_frame_s + 1e-9);
        CHECK((*light)->frames <= std::lround(seconds * 60));
        CHECK((*light)->longest_frame_s >= 1.0 / 60);
    }
    REQUIRE(projector->show_for(white, 0.1));
    CHECK(becomes_true([&] { return session.server.all(0); }));  // the host does nothing
}

TEST_CASE("killing the host during an exposure makes the display black, and the next host can continue") {
    Session session;
    if (cannot_start(session)) return;
    const Server& x = session.server;
    const job::Image grid = test_pattern("grid", {width_px, height_px, 0, 1, 5, 3}).value();
    std::array<int, 2> ends{};
    REQUIRE(::pipe(ends.data()) == 0);
    const pid_t host = ::fork();
    if (host == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        auto projector = ScreenProjector::open("0", display_options());
        const bool good = projector && projector->show_for(grid, 600);
        (void)!::write(ends[1], good ? "1" : "0", 1);
        for (;;) ::pause();
    }
    char lit = 0;
    REQUIRE(::read(ends[0], &lit, 1) == 1);
    REQUIRE(lit == '1');
    CHECK(becomes_true([&] { return x.screenshot() == grid; }));
    const auto second = ScreenProjector::open("0", display_options());
    REQUIRE_FALSE(second);
    CHECK(second.error().message.find("another program is using this panel") != std::string::npos);
    CHECK(x.screenshot() == grid);
    ::kill(host, SIGKILL);
    ::waitpid(host, nullptr, 0);
    CHECK(becomes_true([&] { return x.all(0); }));
    for (int i = 0; i < 20; ++i) {
        CHECK(x.all(0));
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    auto next = ScreenProjector::open("0", display_options());
    REQUIRE_MESSAGE(next, (next ? "" : next.error().message));
    REQUIRE(next->show(grid));
    CHECK(becomes_true([&] { return x.screenshot() == grid; }));
    REQUIRE(next->black());
    CHECK(becomes_true([&] { return x.all(0); }));
}

TEST_CASE("if the process that holds the display is killed, another one makes it black") {
    Session session;
    if (cannot_start(session)) return;
    const Server& x = session.server;
    const job::Image white = test_pattern("ramp", {width_px, height_px, 0, 1, 5, 3}).value();
    auto projector = ScreenProjector::open("0", display_options());
    REQUIRE(projector);
    REQUIRE(projector->show_for(white, 600));
    CHECK(becomes_true([&] { return x.screenshot() == white; }));
    REQUIRE(::kill(projector->holder_process(), SIGKILL) == 0);
    CHECK_FALSE(projector->finish());
    CHECK(becomes_true([&] { return x.all(0); }));
    CHECK(becomes_true([&] { return ScreenProjector::open("0", display_options()).has_value(); }));
}

TEST_CASE("a display of another size, or a missing one, is an error with numbers") {
    Session session;
    if (cannot_start(session)) return;
    const auto wrong = ScreenProjector::open("0", display_options(1920, 1080));
    REQUIRE_FALSE(wrong);
    CAPTURE(wrong.error().message);
    CHECK(wrong.error().message.find("the panel has 320 x 200 px, the images 1920 x 1080 px") != std::string::npos);
    CHECK(ScreenProjector::open("7", display_options()).error().message.find("no display 7") != std::string::npos);

    const auto displays = list_displays(PLIANT_SCREEN_PROGRAM);
    REQUIRE_MESSAGE(displays, (displays ? "" : displays.error().message));
    REQUIRE(displays->size() == 2);
    CHECK((*displays)[0].width_px == width_px);
    CHECK((*displays)[1].height_px == 120);
    // Separate X screens all begin at 0, 0, unlike displays of one screen.
    CHECK(ScreenProjector::open("1", display_options(0, 0)).error().message.find("cannot be told from") !=
          std::string::npos);
}
