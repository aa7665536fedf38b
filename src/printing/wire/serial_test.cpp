#include "printing/wire/serial.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::host;

namespace {

/// A pseudo-terminal whose other end is held by the test.
struct Pty {
    int file = posix_openpt(O_RDWR | O_NOCTTY);
    std::string name;
    Pty() {
        REQUIRE(file >= 0);
        REQUIRE(grantpt(file) == 0);
        REQUIRE(unlockpt(file) == 0);
        name = ptsname(file);
    }
    ~Pty() { close_it(); }
    void close_it() {
        if (file >= 0) ::close(file);
        file = -1;
    }
};

}  // namespace

TEST_CASE("bytes pass a terminal unchanged, at 115200 and 250000 baud") {
    for (const int baud : {115200, 250000}) {
        Pty pty;
        auto wire = SerialWire::open(pty.name, baud);
        REQUIRE_MESSAGE(wire, (wire ? "" : wire.error().message));
        REQUIRE(wire->write("N1 M400*1\r\n\x04\x03"));
        char bytes[64];
        REQUIRE(::read(pty.file, bytes, sizeof bytes) == 13);
        CHECK(std::string(bytes, 13) == "N1 M400*1\r\n\x04\x03");
        REQUIRE(::write(pty.file, "ok\r\n", 4) == 4);
        CHECK(wire->read(1).value() == "ok\r\n");
        CHECK(wire->read(0).value().empty());
    }
}

TEST_CASE("a missing device, one that is no terminal, and one that goes away are errors") {
    CHECK_FALSE(SerialWire::open("/dev/none", 115200));
    CHECK_FALSE(SerialWire::open("/dev/null", 115200));
    Pty pty;
    auto wire = SerialWire::open(pty.name, 115200);
    REQUIRE(wire);
    pty.close_it();
    CHECK_FALSE(wire->read(1));
}

TEST_CASE("a second host on one port is refused; after the first closes it, the port is free") {
    Pty pty;
    {
        auto wire = SerialWire::open(pty.name, 115200);
        REQUIRE(wire);
        const auto second = SerialWire::open(pty.name, 115200);
        REQUIRE_FALSE(second);
        CHECK(second.error().message == pty.name + ": another host has it open");
        const SerialWire moved = std::move(*wire);
        CHECK_FALSE(SerialWire::open(pty.name, 115200));
    }
    CHECK(SerialWire::open(pty.name, 115200));
}

TEST_CASE("ports are listed with the boards behind them") {
    const pliant::test::Folder folder("ports");
    std::filesystem::create_directories(folder / "usb" / "1-1" / "1-1:1.0");
    std::ofstream(folder / "usb" / "1-1" / "product") << "Arduino Mega 2560\n";
    std::filesystem::create_directories(folder / "tty" / "ttyACM0");
    std::filesystem::create_directory_symlink(folder / "usb" / "1-1" / "1-1:1.0",
                                              folder / "tty" / "ttyACM0" / "device");
    std::filesystem::create_directories(folder / "tty" / "tty1");              // a console, not a device
    std::filesystem::create_directories(folder / "tty" / "ttyS0" / "device");  // a port that does not exist
    std::ofstream(folder / "tty" / "ttyS0" / "type") << "0\n";
    const auto ports = serial_ports((folder / "tty").string());
    REQUIRE(ports.size() == 1);
    CHECK(ports[0].device == "/dev/ttyACM0");
    CHECK(ports[0].name == "Arduino Mega 2560");
}
