#include "base/core/error.hpp"

namespace pliant {

std::string shown(const Diagnostic& problem) {
    std::string line = problem.file;
    if (problem.line > 0 && !problem.file.empty()) line += fmt::format(":{}", problem.line);
    if (!line.empty()) line += ": ";
    if (!problem.key.empty()) line += fmt::format("{}: ", problem.key);
    return line + problem.text;
}

Error error_of(Cause cause, std::vector<Diagnostic> problems) {
    std::string lines;
    for (const Diagnostic& problem : problems) {
        if (!lines.empty()) lines += '\n';
        lines += shown(problem);
    }
    return {cause, std::move(lines), std::move(problems)};
}

}  // namespace pliant
