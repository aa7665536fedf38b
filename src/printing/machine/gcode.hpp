// The machine's dialect of G-code: writing and strict parsing of commands. Marlin 2.x understands it.
//
// Rules of the dialect, because the wire may repeat or lose lines: absolute coordinates only, upper case, one command
// per line, no line over `max_line_chars`. Exposures are not commands: they are directives for the host, comments that
// never go to the wire:
//
//     ;@expose layer=12 material=1 seconds=2.500 image=layers/00012_soft.png
//     ;@stop M107 P1          a command that the host sends if it must stop in the middle
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::machine {

inline constexpr std::size_t max_line_chars = 94;  ///< Marlin silently truncates longer lines (MAX_CMD_SIZE 96)

struct Word {
    char letter = '?';
    std::optional<double> value;  ///< none for a bare letter, as in `G28 X`
};

struct Command {
    char letter = '?';  ///< 'G' or 'M'
    int number = 0;
    std::vector<Word> words;
    std::string text;  ///< M117 and M118 only: the message after the parameters

    [[nodiscard]] bool is(char l, int n) const { return letter == l && number == n; }
    [[nodiscard]] bool has(char l) const;
    [[nodiscard]] std::optional<double> value(char l) const;  ///< of the word with that letter, if any
};

/// One command without line number, checksum or comment. Rejects lower case, duplicate letters, malformed numbers or
/// ones beyond 1e9, and control characters.
[[nodiscard]] Result<Command> parse_command(std::string_view line);

/// `line` without its comment and surrounding blanks.
[[nodiscard]] std::string_view strip_comment(std::string_view line);

/// `G1` to `to`, naming only the axes that differ from `from`; "" if none does. `feed_mm_s` is along the path.
[[nodiscard]] std::string write_move(const Printer& printer, const Position& from, const Position& to,
                                     double feed_mm_s);
/// `G28`; `G92` for an axis that a person has placed at its home position.
[[nodiscard]] std::string write_home(const Printer& printer, Axis axis);
/// Commands that must come first: absolute coordinates, and motors that are never disabled when idle (platform and
/// tower would sink).
[[nodiscard]] std::vector<std::string> preamble(const Printer& printer);
/// An order in which homing is safe: nothing moves under the platform unless it is up, no tower beside a carriage that
/// may be in it.
[[nodiscard]] std::vector<Axis> homing_order(const Printer& printer);
/// Whether `command` switches the device on that pin, and to which state. Equivalent forms count: M107 P1 and M106 P1
/// S0 are the same.
[[nodiscard]] std::optional<bool> switched(const Switch& device, const Command& command);
/// Whether both are on the same output of the board; false if either is missing.
[[nodiscard]] bool same_output(const Switch& a, const Switch& b);
/// Whether the device is on while its output is off, as after a loss of power.
[[nodiscard]] bool on_without_power(const Switch& device);
/// Whether `command` writes to the board's pin of the emergency line: only the firmware may.
[[nodiscard]] bool moves_emergency_line(const Printer& printer, const Command& command);
[[nodiscard]] std::string write_dwell(double seconds);

/// The target of a G0 or G1; unnamed axes keep their value in `from`. Fails for letters that are not axes.
[[nodiscard]] Result<Position> move_target(const Printer& printer, const Command& command, const Position& from);

/// The axis with that letter.
[[nodiscard]] std::optional<Axis> axis_of_letter(const Printer& printer, char letter);

/// The content of `;@expose`.
struct Expose {
    int layer = 0;
    int material = 0;  ///< index into the job's materials
    double seconds = 0;
    std::string image;  ///< name inside the job; may contain blanks, no control characters
};

struct Directive {
    std::optional<Expose> expose;
    std::optional<std::string> stop_command;
};

[[nodiscard]] std::string write_expose(const Expose& expose);
[[nodiscard]] std::string write_stop(std::string_view command);

/// Whether `line` is a directive (`;@...`).
[[nodiscard]] bool is_directive(std::string_view line);
/// Parses one; an unknown or incomplete directive is an error.
[[nodiscard]] Result<Directive> parse_directive(std::string_view line);

}  // namespace pliant::machine
