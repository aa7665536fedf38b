// The commands and their options as plain values, read off the parser itself: what completion in shells, man pages and
// the command reference are made from, so that none of them can be out of date.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace pliant::app {

struct OptionEntry {
    std::vector<std::string> names;    ///< "-o", "--output"; of an argument its name alone
    std::string value;                 ///< "TEXT", "INT", "KEY=VALUE"; empty: a flag
    std::string range;                 ///< "1 - 100000" of a number, else empty
    std::string usual;                 ///< what it is where it is not given; empty where the text says so
    std::string help;                  ///< as --help prints it
    std::vector<std::string> choices;  ///< words that may be given; other words too where `open`
    bool open = true;
    bool required = false;
    bool repeated = false;  ///< may be given several times, or has several values
    int values = 0;         ///< how many words follow the name each time
};

struct CommandEntry {
    std::string name;  ///< "simulate", "calibrate tensile"; "" of the program itself
    std::string help, footer;
    std::vector<OptionEntry> arguments, options;
    std::vector<CommandEntry> below;
};

/// Of the program and every command that --help lists.
[[nodiscard]] CommandEntry command_table(const CLI::App& program);

/// JSON with the keys that the structs have.
[[nodiscard]] std::string table_json(const CommandEntry& table);

}  // namespace pliant::app
