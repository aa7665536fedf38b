#include "printing/host/print.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "printing/host/test_devices.hpp"

using namespace pliant;
using namespace pliant::host;
using namespace pliant::host::test;

namespace {

const std::string job_text =
    "; a job\n;@stop M107 P1\nG90\nG1 Z1 F60 ; down\nM400\n;@expose layer=0 material=1 seconds=2.5 image=a.png\nG1 "
    "Z5\n";

Result<job::Image> image_of(int layer, int material) {
    return job::Image{1, 1, {static_cast<std::uint8_t>(10 * layer + material)}};
}

struct CancelAfter final : Progress {
    explicit CancelAfter(int n) : left(n) {}
    [[nodiscard]] bool cancelled() const override { return --left < 0; }
    mutable int left;
};

struct Bench {
    CountingClock clock;
    ScriptedWire wire;
    RememberingProjector projector;
    PrintRecord record;

    explicit Bench(std::function<std::string(const std::string&)> answer) : wire(clock, std::move(answer)) {}

    Status print(const std::string& text, const ImageSource& images = image_of) {
        Progress silent;
        return print(text, silent, images);
    }
    Status print(const std::string& text, Progress& progress, const ImageSource& images = image_of) {
        return print_job(text, images, {wire, projector, clock}, progress, record);
    }
    int index_of(const std::string& part) const {
        for (std::size_t i = 0; i < wire.written.size(); ++i) {
            if (wire.written[i].find(part) != std::string::npos) return static_cast<int>(i);
        }
        return -1;
    }
};

}  // namespace

TEST_CASE("commands go to the wire, light comes behind a fence for its time") {
    Bench b(good_answer);
    const Status status = b.print(job_text);
    REQUIRE_MESSAGE(status, (status ? "" : status.error().message));
    REQUIRE(b.projector.shown.size() == 1);
    CHECK(b.projector.shown[0].pixels[0] == 1);
    CHECK_FALSE(b.projector.lit);
    REQUIRE(b.record.exposures.size() == 1);
    CHECK(b.record.exposures[0].material == 1);
    CHECK(b.record.exposures[0].on_s == near(2.5, {.relative = 1e-12}));
    CHECK(b.index_of("tok 1*") > b.index_of("G1 Z1"));
    CHECK(b.index_of("G1 Z5") > b.index_of("tok 1*"));
    CHECK(b.index_of("expose") == -1);
    CHECK(b.index_of("M410") == -1);
    // G90, G1, M400, fence, G1, fence: 3 + 2 + 1 + 2.
    CHECK(b.record.lines_sent == 8);
}

TEST_CASE("a bad job is refused before anything is sent") {
    for (const char* text : {"G90\nhello\n", ";@expose layer=0\n", "G1 X1 X2\n"}) {
        Bench b(good_answer);
        const Status status = b.print(text);
        REQUIRE_FALSE(status);
        CHECK(status.error().cause == Cause::input);
        CHECK(b.wire.written.empty());
    }
}

TEST_CASE("any failure leaves the projector black, stops motion and switches off") {
    Bench b([](const std::string& line) {
        return line.find("Z5") != std::string::npos ? std::string("Error:interlock: no\n") : good_answer(line);
    });
    CHECK_FALSE(b.print(job_text));
    CHECK_FALSE(b.projector.lit);
    CHECK(b.index_of("M410") > b.index_of("G1 Z5"));
    CHECK(b.wire.written.back() == "M107 P1");
    CHECK(b.record.exposures.size() == 1);
}

TEST_CASE("an image that cannot be had stops the print in the dark") {
    Bench b(good_answer);
    CHECK_FALSE(b.print(job_text, [](int, int) -> Result<job::Image> { return input_error("gone"); }));
    CHECK(b.projector.shown.empty());
    CHECK(b.index_of("M410") > 0);
}

TEST_CASE("cancelling in the middle of an exposure is prompt") {
    Bench b(good_answer);
    CancelAfter cancel(10);
    const Status status = b.print(job_text, cancel);
    REQUIRE_FALSE(status);
    CHECK(status.error().cause == Cause::cancelled);
    CHECK_FALSE(b.projector.lit);
    REQUIRE(b.record.exposures.size() == 1);
    CHECK(b.record.exposures[0].on_s < 1);
    CHECK(b.wire.written.back() == "M107 P1");
}

TEST_CASE("after a restart nothing more is sent") {
    Bench b([](const std::string& line) {
        return line.find("Z5") != std::string::npos ? std::string("start\n") : good_answer(line);
    });
    CHECK_FALSE(b.print(job_text));
    CHECK(b.index_of("M410") == -1);
    CHECK_FALSE(b.projector.lit);
}
