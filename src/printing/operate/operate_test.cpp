#include <doctest/doctest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "printing/job/png.hpp"
#include "printing/operate/clock_file.hpp"
#include "printing/operate/layer_command.hpp"
#include "printing/operate/picture_projector.hpp"
#include "printing/wire/scaled_time.hpp"

using namespace pliant;
using namespace pliant::operate;

namespace {

/// Nothing ever arrives; every look takes the printer 0.1 s.
class SilentWire final : public host::Wire {
public:
    explicit SilentWire(const ClockFile* clock) : clock_(clock) {}
    [[nodiscard]] Status write(std::string_view) override { return {}; }
    [[nodiscard]] Result<std::string> read(double timeout_s) override {
        CHECK(timeout_s == 0);
        if (clock_ != nullptr) clock_->set(clock_->now() + 0.1);
        return std::string();
    }

private:
    const ClockFile* clock_;
};

}  // namespace

TEST_CASE("with a folder as projector the picture is there exactly during the exposure") {
    const pliant::test::Folder folder;
    {
        PictureProjector projector(folder.path());
        REQUIRE(projector.black());
        REQUIRE(projector.show({2, 1, {0, 200}}));
        const auto image = job::decode_png(read_file(projector.shown()).value(), {2, 1}, "shown").value();
        CHECK(image.pixels == std::vector<std::uint8_t>{0, 200});
        REQUIRE(projector.black());
        CHECK_FALSE(std::filesystem::exists(projector.shown()));
        REQUIRE(projector.show({2, 1, {0, 200}}));
    }
    CHECK(std::filesystem::is_empty(folder.path()));
    PictureProjector nowhere(folder.path() / "none");
    CHECK_FALSE(nowhere.show({2, 1, {0, 200}}));
}

TEST_CASE("the command after a layer knows the layer's number; its failure or timeout is reported") {
    const pliant::test::Folder folder;
    const std::string file = (folder.path() / "layer").string();
    CHECK(run_layer_command("echo -n $PLIANT_LAYER > " + file, 12));
    CHECK(read_file(file).value() == "12");
    CHECK_FALSE(run_layer_command("exit 3", 0));
    CHECK(run_layer_command("sleep 60", 0, 0.05).error().message.find("took over") != std::string::npos);
}

TEST_CASE("child processes of a command are killed with it") {
    const pliant::test::Folder folder;
    const auto late = folder.path() / "late";
    const Status status = run_layer_command("(sleep 0.3; touch " + late.string() + ") & wait", 0, 0.05);
    CHECK(status.error().message.find("took over") != std::string::npos);
    ::usleep(600000);
    CHECK_FALSE(std::filesystem::exists(late));
}

TEST_CASE("host and virtual printer share a clock through a file") {
    const pliant::test::Folder folder;
    const auto path = folder.path() / "clock";
    CHECK_FALSE(ClockFile::open(path).has_value());
    auto printer = ClockFile::create(path);
    REQUIRE(printer.has_value());
    auto host = ClockFile::open(path);
    REQUIRE(host.has_value());
    CHECK(host->now() == 0);
    printer->set(12.5);
    CHECK(host->now() == 12.5);
    // The host sleeps for the printer's time, however long that is.
    std::thread time([&] {
        for (int i = 1; i <= 20; ++i, ::usleep(1000)) printer->set(12.5 + 0.1 * i);
    });
    host->sleep(1.5);
    CHECK(host->now() >= 14);
    time.join();
    ClockFile moved = std::move(*host);
    CHECK(moved.now() == 14.5);
}

TEST_CASE("a new clock takes the place of an old one, which a host may still read") {
    const pliant::test::Folder folder;
    const auto path = folder.path() / "clock";
    {
        const auto before = ClockFile::create(path);
        REQUIRE(before.has_value());
        before->set(3);
    }
    const auto host = ClockFile::open(path);
    REQUIRE(host.has_value());
    const auto printer = ClockFile::create(path);
    REQUIRE(printer.has_value());
    CHECK(printer->now() == 0);
    printer->set(7);
    CHECK(host->now() == 3);
}

TEST_CASE("waiting for an answer ends by the printer's clock, and does not outlast the printer") {
    const pliant::test::Folder folder;
    const auto clock = ClockFile::create(folder.path() / "clock");
    REQUIRE(clock.has_value());
    host::ClockedWire wire(std::make_unique<SilentWire>(&*clock), *clock);
    CHECK(wire.read(3).value().empty());
    CHECK(clock->now() >= 3);
    CHECK(clock->now() < 3.15);  // one step of the clock too long at most
    host::ClockedWire dead(std::make_unique<SilentWire>(nullptr), *clock);
    CHECK(dead.read(0.01).value().empty());
}

TEST_CASE("a clock that never moves is that of another printer: an error, before anything is waited for by it") {
    const pliant::test::Folder folder;
    const auto clock = ClockFile::create(folder.path() / "clock");
    REQUIRE(clock.has_value());
    host::ClockedWire still(std::make_unique<SilentWire>(nullptr), *clock, 0.2);
    Result<std::string> heard = still.read(0.01);
    for (int i = 0; heard.has_value() && i < 1000; ++i) heard = still.read(0.01);
    REQUIRE_FALSE(heard.has_value());
    CHECK(heard.error().message == "the clock does not move; is it that of this printer?");
    constexpr double most_still_s = 0.5;
    host::ClockedWire moving(std::make_unique<SilentWire>(&*clock), *clock, most_still_s);
    CHECK(moving.read(0.1).has_value());
    std::this_thread::sleep_for(std::chrono::duration<double>(1.2 * most_still_s));
    CHECK(moving.read(0.1).has_value());
}

TEST_CASE("a file that is not a clock is refused, and not changed") {
    const pliant::test::Folder folder;
    const auto path = folder.path() / "clock";
    for (const std::string text : {"", "1234567", "123456789"}) {
        REQUIRE(write_file(path, text));
        const auto clock = ClockFile::open(path);
        REQUIRE_FALSE(clock.has_value());
        CHECK(clock.error().message == path.string() + ": not the clock of a virtual printer");
        CHECK_FALSE(ClockFile::create(path).has_value());
        CHECK(read_file(path).value() == text);
    }
    CHECK_FALSE(ClockFile::create(folder.path() / "none/clock").has_value());
}
