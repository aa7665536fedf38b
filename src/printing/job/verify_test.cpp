#include "printing/job/verify.hpp"

#include <doctest/doctest.h>

#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::job;
namespace fs = std::filesystem;

namespace {

/// A job of one layer with two images of 10 pixels, the second starting at `column`, with the given areas.
std::string verdict(int column, double area_mm2, bool corrected = false, double shared_mm2 = 0) {
    const pliant::test::Folder folder("verify");
    const fs::path path = folder / "job.zip";
    slice::RunImage a(64, 48), b(64, 48);
    a.append(5, 10, 20, 255);
    b.append(5, column, column + 10, 255);
    Manifest m{"x", "0", 64, 48, 100, 0, {{"s", "s", 0, 0, 1, 1}, {"r", "r", 0, 0, 1, 1}}, {}, {}};
    m.layers.push_back({50, 50, {{0, "layers/a.png", area_mm2}, {1, "layers/b.png", 0.1, 0, shared_mm2}}});
    auto writer = Writer::create(path);
    REQUIRE(writer->add_image("layers/a.png", encode(a)).has_value());
    REQUIRE(writer->add_image("layers/b.png", encode(b)).has_value());
    REQUIRE(writer->finish(m).has_value());
    const auto archive = Archive::open(path);
    REQUIRE(archive.has_value());
    const Status status = verify_images(*archive, corrected, "job.zip");
    return status ? "" : status.error().message;
}

}  // namespace

TEST_CASE("areas must agree and no pixel may be lit twice") {
    CHECK(verdict(20, 0.1).empty());
    CHECK(verdict(20, 0.11) == "job.zip: layers/a.png: its pixels hold 0.1 mm^2, the manifest says 0.11");
    CHECK(verdict(20, 0.11, true).empty());
    CHECK(verdict(19, 0.1) ==
          "job.zip: layer 1: layers/a.png and layers/b.png both light the pixel at row 5, column 19");
}

TEST_CASE("pixels may be lit twice as far as the manifest allows it") {
    CHECK(verdict(17, 0.1, false, 0.03).empty());
    CHECK(verdict(17, 0.1, false, 0.02) ==
          "job.zip: layer 1: layers/a.png and layers/b.png both light the pixel at row 5, column 17");
    CHECK(verdict(17, 0.1, true, 0.02).empty());
    CHECK(!verdict(17, 0.1, true).empty());
}
