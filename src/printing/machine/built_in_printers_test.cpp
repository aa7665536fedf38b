#include "printing/machine/built_in_printers.hpp"

#include <doctest/doctest.h>

#include "base/core/files.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::machine {
namespace {

TEST_CASE("every built-in printer is valid, and named as its file") {
    CHECK(built_in_printers().size() >= 5);
    for (const EmbeddedFile& file : built_in_printers()) {
        CAPTURE(file.name);
        const std::string path = "examples/printers/" + std::string(file.name) + ".toml";
        CHECK(read_file(path).value_or("") == file.text);
        CHECK(parse_printer(file.text, path));
        CHECK(is_built_in_printer(std::string(file.name)));
        CHECK(read_printer_text(std::string(file.name)).value_or("") == file.text);
    }
}

TEST_CASE("a printer file is read from the disk, by a path or by a name without a dot") {
    CHECK_FALSE(is_printer_name("examples/printers/tower.toml"));
    CHECK(read_printer_text("examples/printers/tower.toml").value_or("") ==
          find_file(built_in_printers(), "tower")->text);
    REQUIRE(write_file("tower", "mine"));
    CHECK_FALSE(is_built_in_printer("tower"));
    CHECK(read_printer_text("tower").value_or("") == "mine");
    std::filesystem::remove("tower");
    CHECK(is_built_in_printer("tower"));
}

TEST_CASE("a name that is none is told with the nearest one") {
    CHECK(read_printer_text("towr").error().message ==
          "towr: there is no such file or built-in printer; did you mean \"tower\"?");
    CHECK(read_printer_text("qqqqqq").error().message.find("built in are ") != std::string::npos);
    CHECK(read_printer_text("missing/tower.toml").error().message.find("missing/tower.toml") != std::string::npos);
}

}  // namespace
}  // namespace pliant::machine
