#include "printing/machine/gcode.hpp"

#include <doctest/doctest.h>

#include "base/core/letters.hpp"

using namespace pliant;
using namespace pliant::machine;

namespace {

Printer three_axes() {
    Printer p;
    p.name = "test";
    p.axes[0].letter = 'X';
    p.axes[1].letter = 'Z';
    p.axes[2].letter = 'Y';
    return p;
}

}  // namespace

TEST_CASE("a command is read into letter, number and words") {
    const auto c = parse_command("G1 X-1.5 Z20 F912");
    REQUIRE(c);
    CHECK(c->is('G', 1));
    CHECK(c->value('X') == -1.5);
    CHECK(c->value('Z') == 20);
    CHECK_FALSE(c->value('Y'));
    const auto home = parse_command("G28 X");
    REQUIRE(home);
    CHECK(home->has('X'));
    CHECK_FALSE(home->value('X'));
}

TEST_CASE("M118 keeps its message") {
    const auto c = parse_command("M118 E1 tok 17");
    REQUIRE(c);
    CHECK(c->value('E') == 1);
    CHECK(c->text == "tok 17");
}

TEST_CASE("anything but a strict command is refused") {
    for (const char* line : {"", "g1 X1", "G", "Gx", "G1 X1 X2", "G1 X1..2", "G1 X1e400", "G1 Xnan", "G1 x1", "T0",
                             "G1 X1;", "G1 X1\nG1", "G-1", "G99999", "N1 G1 X1*33", "G1 X2000000000"}) {
        CAPTURE(line);
        CHECK_FALSE(parse_command(line));
    }
}

TEST_CASE("an exponent is refused: Marlin ends a number there") {
    CHECK(parse_command("G1 X2.4E2").error().message ==
          "\"X2.4E2\" has an exponent, which Marlin does not read: write X240");
    CHECK(parse_command("G1 Z1 F9e2").error().message ==
          "\"F9e2\" has an exponent, which Marlin does not read: write F900");
    CHECK(parse_command("G4 P1e-3").error().message.find("write P0.001") != std::string::npos);
    CHECK(parse_command("G1 E240")->value('E') == 240);
    CHECK(parse_command("M118 E1 1E2")->text == "1E2");
}

TEST_CASE("a name in a comment cannot begin a line of its own") {
    CHECK(one_line("rob\nM42 P4 S255\r\x7f;") == "rob M42 P4 S255  ;");
    CHECK(one_line("Füße") == "Füße");
}

TEST_CASE("comments, blanks and line ends are removed") {
    CHECK(strip_comment("  G1 X1 ; there") == "G1 X1");
    CHECK(strip_comment("; only") == "");
    CHECK(strip_comment("G1\r") == "G1");
}

TEST_CASE("a move names only the axes that change, and is read back the same") {
    const Printer p = three_axes();
    const Position from{{1000, 2000, 3000}};
    const Position to{{1000, 2050, 3001}};
    const std::string line = write_move(p, from, to, 15.2);
    CHECK(line == "G1 Z2.050 Y3.001 F912.0");
    CHECK(move_target(p, parse_command(line).value(), from).value() == to);
    CHECK(write_move(p, from, from, 15.2).empty());
    CHECK_FALSE(move_target(p, parse_command("G1 E3").value(), from));
    CHECK_FALSE(move_target(p, parse_command("G1 X").value(), from));
}

TEST_CASE("directives are read back as written") {
    const auto d = parse_directive(write_expose({12, 1, 2.5, "layers/00012_soft.png"}));
    REQUIRE(d);
    REQUIRE(d->expose);
    CHECK(d->expose->layer == 12);
    CHECK(d->expose->material == 1);
    CHECK(d->expose->seconds == 2.5);
    CHECK(d->expose->image == "layers/00012_soft.png");
    CHECK(parse_directive(write_expose({1, 0, 2, "layers/a b.png"}))->expose->image == "layers/a b.png");
    CHECK(parse_directive(write_stop("M107 P1"))->stop_command == "M107 P1");
}

TEST_CASE("a damaged directive is an error") {
    for (const char* line :
         {";@", ";@expos layer=1", ";@expose", ";@expose layer=1 material=0 seconds=2",
          ";@expose layer=-1 material=0 seconds=2 image=a", ";@stop", ";@stop rm -rf",
          ";@expose layer=1 material=0 seconds=1e9 image=a", ";@expose layer=1 material=0 seconds=nan image=a",
          ";@expose layer=1 material=0 seconds=2 more=1 image=a"}) {
        CAPTURE(line);
        CHECK_FALSE(parse_directive(line));
    }
}
