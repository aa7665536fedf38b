// Errors for people: one line that says where, what is wrong and what would be right.
#pragma once

#include <fmt/core.h>

#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

namespace pliant {

/// Why something could not be done; the command line turns it into an exit status.
enum class Cause {
    input,      ///< bad input or usage: exit status 2
    failed,     ///< the work itself failed (did not converge, print stopped): exit status 1
    cancelled,  ///< the caller asked to stop: exit status 1
};

/// One problem and its place, for an editor to mark or a script to look up. Fields that are unknown are empty or 0.
struct Diagnostic {
    std::string file;
    int line = 0;      ///< from 1
    std::string key;   ///< the key in the file, or kind and name of the object concerned: body "tip"
    std::string text;  ///< what is wrong and what would be right
    bool operator==(const Diagnostic&) const = default;
};
/// "FILE:LINE: KEY: TEXT", without the parts that are unknown.
[[nodiscard]] std::string shown(const Diagnostic& problem);

struct Error {
    Cause cause = Cause::input;
    std::string message;                 ///< one line per problem, without a trailing newline
    std::vector<Diagnostic> problems{};  ///< the same as data, if the error is about places in a file; else empty
};

template <class T>
using Result = tl::expected<T, Error>;
using Status = Result<void>;

/// From problems, shown one per line.
[[nodiscard]] Error error_of(Cause cause, std::vector<Diagnostic> problems);

/// `return input_error("{}: ...", file);`
template <class... Args>
tl::unexpected<Error> input_error(fmt::format_string<Args...> text, Args&&... args) {
    return tl::unexpected(Error{Cause::input, fmt::format(text, std::forward<Args>(args)...)});
}

/// `return input_error_at(file, line, "...", ...);` for a line of a file.
template <class... Args>
tl::unexpected<Error> input_error_at(std::string file, int line, fmt::format_string<Args...> text, Args&&... args) {
    return tl::unexpected(
        error_of(Cause::input, {{std::move(file), line, "", fmt::format(text, std::forward<Args>(args)...)}}));
}

template <class... Args>
tl::unexpected<Error> failure(fmt::format_string<Args...> text, Args&&... args) {
    return tl::unexpected(Error{Cause::failed, fmt::format(text, std::forward<Args>(args)...)});
}

inline tl::unexpected<Error> cancelled() {
    return tl::unexpected(Error{Cause::cancelled, "cancelled"});
}

}  // namespace pliant
