#include "printing/prepare/paint_file.hpp"

#include <doctest/doctest.h>

#include "base/core/test_text.hpp"

using namespace pliant;
using namespace pliant::prepare;
using pliant::test::holds;

namespace {

const std::string head = "wish,x (mm),y (mm),z (mm),nx,ny,nz,radius (mm)\n";

std::string refused_paint(const std::string& text) {
    const auto read = read_paint(text, "p.csv");
    return read ? "" : read.error().message;
}

}  // namespace

TEST_CASE("strokes of painted supports are read in order, in micrometres") {
    const auto read =
        read_paint(head + "enforce,10,5,0.5,0,0,-1,2\n# rubbed out\nusual,1,2,3,0,-0.6,-0.8,1\n", "p.csv");
    REQUIRE(read.has_value());
    REQUIRE(read->size() == 2);
    CHECK((*read)[0].wish == slice::SupportWish::enforce);
    CHECK((*read)[0].at_um == Vec3{10000, 5000, 500});
    CHECK((*read)[0].radius_um == 2000);
    CHECK((*read)[1].wish == slice::SupportWish::usual);
    CHECK((*read)[1].normal == Vec3{0, -0.6, -0.8});
}

TEST_CASE("mistakes in a table of painted supports are reported with their line") {
    CHECK(holds(refused_paint("wish,x (mm)\nblock,1\n"), "p.csv:1: there is no column \"y (mm)\""));
    CHECK(
        holds(refused_paint(head + "forbid,1,2,3,0,0,-1,1\n"), "p.csv:2: \"forbid\" must be enforce, block or usual"));
    CHECK(holds(refused_paint(head + "block,1,2,3,0,0,-1,0\n"), "p.csv:2: painted supports: a radius of 0 mm"));
    CHECK(holds(refused_paint(head + "block,1,2,3,0,0,0,1\n"), "p.csv:2: painted supports: a normal of length 0"));
    CHECK(holds(refused_paint(head + "block,1,2,inch,0,0,-1,1\n"), "p.csv:2"));
    CHECK(holds(refused_paint(head + "block,1,2\n"), "p.csv:2"));
    CHECK_FALSE(refused_paint("").empty());
}
