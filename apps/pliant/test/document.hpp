// Commands in a document and their expected output, for the test that runs documents.
//
// Executed are lines that begin with `$ ` in fenced blocks (the lines up to the next one are the output, a line `...`
// stands for any lines), and lines in the text that are a whole command of Pliant, indented by four or in backquotes.
// Synopses, which have placeholders, are not. Manual steps of the reader are given in comments:
//
//   <!-- run: save FILE -->                        the next fenced block is FILE
//   <!-- run: insert before LINE in FILE -->       it goes there, before the line that begins so
//   <!-- run: replace LINE; LINE in FILE -->       it goes in place of lines that begin so; of tables, if `[`
//   <!-- run: first COMMAND -->                    run in the shell, not shown
//   <!-- run: with OPTIONS -->                     the next command gets more options
//   <!-- run: Ctrl-C after N -->                   it is interrupted after N seconds; it may print more than is shown
//   <!-- run: any N N -->                          these numbers (from 1) of an output line may have any value
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
    std::string file;                 ///< for save, insert and replace
    std::vector<std::string> places;  ///< beginnings of lines of `file`, for insert and replace
    bool shows_output = false;
    std::vector<std::string> output;  ///< expected output lines
    std::string options;              ///< appended to the command
    int interrupt_s = 0;              ///< 0: never
    std::set<int> any;                ///< positions (from 1) of numbers in a line that are not compared
    std::string reason;               ///< reason for skipping it
};

/// Errors: a comment `run:` that is none of the above, or without a following block or command.
[[nodiscard]] Result<std::vector<DocumentStep>> document_steps(std::string_view text);

/// `file` with the step's block inserted. Errors: no line begins so.
[[nodiscard]] Result<std::string> edited(std::string_view file, const DocumentStep& step);

/// "" if `printed` matches the step's output, else the first differing line. Words must be equal, except for spaces.
/// Numbers may differ by 0.5 % or two of their last digit; wall times (after "steps in") and residuals (after
/// "residual") are not compared.
[[nodiscard]] std::string difference(const DocumentStep& step, const std::vector<std::string>& printed);

/// `text` with the actual output in place of the expected one; blocks with a line `...` are kept. `printed` per step.
[[nodiscard]] std::string updated(std::string_view text, const std::vector<DocumentStep>& steps,
                                  const std::vector<std::vector<std::string>>& printed);

}  // namespace pliant::app
