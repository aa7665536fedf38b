// What a document shows of a command line: commands, and what they print. For the test that runs them as they stand.
//
// Run are lines that begin with `$ ` in fenced blocks (what follows up to the next one is what they print, a line
// `...` standing for any lines), and lines in the text that are a whole command of Pliant, indented by four or in
// backquotes. Synopses, which have placeholders, are not. What a reader does by hand stands in comments:
//
//   <!-- run: save FILE -->                        the next fenced block is FILE
//   <!-- run: insert before LINE in FILE -->       it goes there, before the line that begins so
//   <!-- run: replace LINE; LINE in FILE -->       it goes in place of lines that begin so; of tables, if `[`
//   <!-- run: first COMMAND -->                    in the shell, unseen
//   <!-- run: with OPTIONS -->                     the next command gets more options
//   <!-- run: Ctrl-C after N -->                   it is interrupted after N seconds; it may print more than is shown
//   <!-- run: any N N -->                          of the numbers of a line that it prints, these (from 1) may be any
//   <!-- run: not REASON -->                       the next command, or all of the next block, are not run
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::app {

struct DocumentStep {
    enum class Kind { command, shell, save, insert, replace, skipped };
    Kind kind = Kind::command;
    int line = 0;                     ///< of the command or comment, from 1
    std::string text;                 ///< the command, or the block that goes into `file`
    std::string file;                 ///< of save, insert and replace
    std::vector<std::string> places;  ///< what lines of `file` begin with, of insert and replace
    bool shows_output = false;
    std::vector<std::string> output;  ///< its lines follow the command's in the document
    std::string options;              ///< that are added to the command
    int interrupt_s = 0;              ///< 0: never
    std::set<int> any;                ///< numbers of a line, from 1, that are not compared
    std::string reason;               ///< why it is skipped
};

/// Errors: a comment `run:` that is none of the above, or whose block or command does not follow.
[[nodiscard]] Result<std::vector<DocumentStep>> document_steps(std::string_view text);

/// `file` with the step's block in its place. Errors: no line begins so.
[[nodiscard]] Result<std::string> edited(std::string_view file, const DocumentStep& step);

/// "" if `printed` is what the step shows, else the first line that is not. Words must be the same, but for spaces.
/// Numbers may differ by 0.5 % or two of their last digit, times by the clock on the wall (after "steps in") and
/// residuals (after "residual") in any way.
[[nodiscard]] std::string difference(const DocumentStep& step, const std::vector<std::string>& printed);

/// `text` with what was printed in place of what the steps show; blocks with a line `...` stay. `printed` per step.
[[nodiscard]] std::string updated(std::string_view text, const std::vector<DocumentStep>& steps,
                                  const std::vector<std::vector<std::string>>& printed);

}  // namespace pliant::app
