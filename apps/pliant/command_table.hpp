// The commands and their options as plain values, extracted from the parser: the source of shell completion, man pages
// and the command reference, which therefore cannot be out of date.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace pliant::app {

struct OptionEntry {
    std::vector<std::string> names;    ///< "-o", "--output"; for an argument only its name
    std::string value;                 ///< "TEXT", "INT", "KEY=VALUE"; empty: a flag
    std::string range;                 ///< "1 - 100000" for a number, else empty
    std::string usual;                 ///< default value; empty if the help text gives it
    std::string help;                  ///< as --help prints it
    std::vector<std::string> choices;  ///< allowed words; further ones too if `open`
    bool open = true;
    bool required = false;
    bool repeated = false;  ///< may be given several times, or takes several values
    int values = 0;         ///< number of values that follow the name each time
};

struct CommandEntry {
    std::string name;  ///< "simulate", "calibrate tensile"; "" for the program itself
    std::string help, footer;
    std::vector<OptionEntry> arguments, options;
    std::vector<CommandEntry> below;
};

/// The program and every command that --help lists.
[[nodiscard]] CommandEntry command_table(const CLI::App& program);

/// JSON with the keys that the structs have.
[[nodiscard]] std::string table_json(const CommandEntry& table);

}  // namespace pliant::app
