// The projector with a folder as its panel: what a host can do with it, and what happens when the host ends.
#include "printing/screen/projector.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "printing/job/png.hpp"
#include "printing/screen/test_waiting.hpp"

using namespace pliant;
using namespace pliant::host;
using pliant::host::test::becomes_true;

namespace {

job::Image noise(int seed) {
    job::Image image{64, 48, std::vector<std::uint8_t>(64 * 48)};
    std::uint32_t state = static_cast<std::uint32_t>(seed) * 2654435761U + 1;
    for (auto& pixel : image.pixels) pixel = static_cast<std::uint8_t>((state = state * 1664525U + 1013904223U) >> 24);
    return image;
}

/// The panel's folder, created by the projector.
struct Folder {
    explicit Folder(const std::string& name) : place(name) {}
    pliant::test::Folder place;
    std::filesystem::path path = place / "panel";

    [[nodiscard]] bool lit() const { return std::filesystem::exists(path / "shown.png"); }
    [[nodiscard]] job::Image image(const std::string& name) const {
        const auto bytes = read_file(path / name);
        REQUIRE_MESSAGE(bytes, name);
        const auto read = job::decode_png(*bytes, {64, 48}, name);
        REQUIRE(read);
        return *read;
    }
};

ScreenOptions options() {
    return {64, 48, 3600, PLIANT_SCREEN_PROGRAM};
}

}  // namespace

TEST_CASE("exposures appear in the folder, end by themselves, are measured, and leave their images") {
    Folder folder("lights");
    {
        auto projector = ScreenProjector::open(folder.path.string(), options());
        REQUIRE_MESSAGE(projector, (projector ? "" : projector.error().message));
        CHECK_FALSE(folder.lit());
        for (int i = 1; i <= 3; ++i) {
            REQUIRE(projector->show_for(noise(i), 0.1 * i));
            const auto light = projector->finish();
            CHECK_FALSE(folder.lit());
            REQUIRE(light);
            REQUIRE(*light);
            CHECK((*light)->asked_s == near(0.1 * i, {.relative = 1e-12}));
            // To half a frame; longer only by the delay of the last two frames.
            CHECK((*light)->on_s <= 0.1 * i - 1.5 / 60 + 2 * (*light)->longest_frame_s + 1e-9);
            CHECK((*light)->on_s >= 0.1 * i - 0.5 / 60 - 1e-9);
        }
        REQUIRE(projector->show(noise(4)));
        CHECK(folder.image("shown.png") == noise(4));
        REQUIRE(projector->black());
        CHECK_FALSE(folder.lit());
        CHECK(projector->last_light()->asked_s == 3600);
        CHECK(projector->last_light()->on_s < 3600);
    }
    for (int i = 1; i <= 4; ++i) CHECK(folder.image("0000" + std::to_string(i) + ".png") == noise(i));
}

TEST_CASE("a later projector keeps the images of an earlier one: its numbers go on") {
    Folder folder("later");
    for (int run = 0; run < 2; ++run) {
        auto projector = ScreenProjector::open(folder.path.string(), options());
        REQUIRE_MESSAGE(projector, (projector ? "" : projector.error().message));
        for (int i = 1; i <= 2; ++i) {
            REQUIRE(projector->show_for(noise(2 * run + i), 0.05));
            REQUIRE(projector->finish());
        }
    }
    for (int i = 1; i <= 4; ++i) CHECK(folder.image("0000" + std::to_string(i) + ".png") == noise(i));
}

TEST_CASE("an exposure ends without the host, and a new one replaces a running one") {
    Folder folder("stalled");
    auto projector = ScreenProjector::open(folder.path.string(), options());
    REQUIRE(projector);
    REQUIRE(projector->show_for(noise(1), 0.2));
    CHECK(becomes_true([&] { return !folder.lit(); }));  // the host says and does nothing
    REQUIRE(projector->show_for(noise(2), 60));
    CHECK(folder.image("shown.png") == noise(2));
    CHECK(projector->last_light()->asked_s == near(0.2, {.relative = 1e-12}));
    REQUIRE(projector->show_for(noise(3), 60));
    CHECK(folder.image("shown.png") == noise(3));
    CHECK(projector->last_light()->asked_s == 60);
}

TEST_CASE("when the host ends, also by kill -9, the exposure ends") {
    for (const int signal : {SIGKILL, SIGTERM, SIGSEGV, 0}) {
        Folder folder("killed");
        int ends[2];
        REQUIRE(::pipe(ends) == 0);
        const pid_t host = ::fork();
        if (host == 0) {
            ::prctl(PR_SET_PDEATHSIG, SIGKILL);
            ::signal(SIGSEGV, SIG_DFL);
            ::signal(SIGTERM, SIG_DFL);
            auto projector = ScreenProjector::open(folder.path.string(), options());
            const bool good = projector && projector->show_for(noise(1), 600);
            (void)!::write(ends[1], good ? "1" : "0", 1);
            if (signal == 0) ::_exit(0);
            for (;;) ::pause();
        }
        char lit = 0;
        REQUIRE(::read(ends[0], &lit, 1) == 1);
        REQUIRE(lit == '1');
        if (signal != 0) {
            CHECK(folder.image("shown.png") == noise(1));
            ::kill(host, signal);
        }
        CHECK(becomes_true([&] { return !folder.lit(); }));
        int how = 0;
        ::waitpid(host, &how, 0);
        ::close(ends[0]);
        ::close(ends[1]);
    }
}

TEST_CASE("a folder has one host; images of another size and exposures of no length are refused") {
    Folder folder("one");
    auto projector = ScreenProjector::open(folder.path.string(), options());
    REQUIRE(projector);
    const auto second = ScreenProjector::open(folder.path.string(), options());
    REQUIRE_FALSE(second);
    CHECK(second.error().message.find("another program") != std::string::npos);

    job::Image wide{65, 48, std::vector<std::uint8_t>(65 * 48)};
    CHECK(projector->show_for(wide, 1).error().message.find("65 x 48 px on a panel of 64 x 48 px") !=
          std::string::npos);
    CHECK_FALSE(projector->show_for(noise(1), 0));
    CHECK_FALSE(projector->show_for(noise(1), std::nan("")));
    CHECK_FALSE(folder.lit());
    CHECK(projector->show_for(noise(1), 0.05));
    CHECK(projector->finish());
}

TEST_CASE("errors on opening give their reason") {
    ScreenOptions other = options();
    other.program = "/nowhere/pliant-screen";
    CHECK(ScreenProjector::open("/tmp", other).error().message.find("/nowhere/pliant-screen") != std::string::npos);
    ScreenOptions sizeless = options();
    sizeless.width_px = 0;
    CHECK(ScreenProjector::open("/tmp", sizeless).error().message.find("needs the size") != std::string::npos);
    CHECK(ScreenProjector::open("/proc/pliant", options()).error().message.find("/proc/pliant") != std::string::npos);
}

TEST_CASE("if the process that holds the panel dies, the host gets an error and the light is off") {
    Folder folder("holder");
    auto projector = ScreenProjector::open(folder.path.string(), options());
    REQUIRE(projector);
    REQUIRE(projector->show_for(noise(1), 600));
    REQUIRE(projector->holder_process() > 0);
    REQUIRE(::kill(projector->holder_process(), SIGKILL) == 0);
    CHECK_FALSE(projector->finish());
    CHECK(becomes_true([&] { return !folder.lit(); }));
}
