#include "base/core/error.hpp"

namespace pliant {

std::string shown(const Diagnostic& problem) {
    const std::string line = problem.line > 0 && !problem.file.empty() ? fmt::format(":{}", problem.line) : "";
    return fmt::format("{}{}{}{}{}{}", problem.file, line, problem.file.empty() ? "" : ": ", problem.key,
                       problem.key.empty() ? "" : ": ", problem.text);
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
