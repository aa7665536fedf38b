// A host's end of the virtual printer's wire, for the tests of this module.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

#include "printing/twin/twin.hpp"

namespace pliant::twin::test {

/// The tower's twin and its host. `wait_s` is in the twin's own time.
struct Peer {
    machine::Printer printer = machine::load_printer("examples/printers/tower.toml").value();
    Twin twin;
    long number = 0;

    explicit Peer(Options options = {}) : twin(printer, std::move(options)) { (void)twin.take_output(); }

    /// Sends bytes unchanged; returns the answer.
    std::string raw(const std::string& bytes, double wait_s = 0) {
        twin.receive(bytes);
        twin.advance_to(twin.now() + wait_s);
        return twin.take_output();
    }
    /// Sends the next numbered line; returns the answer.
    std::string send(const std::string& command, double wait_s = 0) { return raw(line(++number, command), wait_s); }
    static std::string line(long n, const std::string& command) {
        const std::string body = fmt::format("N{} {}", n, command);
        return fmt::format("{}*{}\n", body, checksum(body));
    }
    void home() {
        for (const char* axis : {"G28 Z", "G28 X", "G28 Y"}) send(axis, 100);
    }
    /// Target of the platform, and its position.
    [[nodiscard]] int z_um() const { return twin.interlock().position()[machine::Axis::platform]; }
    [[nodiscard]] int z_um_now() const { return twin.motors_position()[machine::Axis::platform]; }
};

}  // namespace pliant::twin::test
