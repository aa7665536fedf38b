// Errors for people: one line that says where, what is wrong and what would be right.
#pragma once

#include <fmt/core.h>

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace pliant {

/// Why something could not be done; the command line turns it into an exit status.
enum class Cause {
    input,      ///< bad input or usage: exit status 2
    failed,     ///< the work itself failed (did not converge, print stopped): exit status 1
    cancelled,  ///< the caller asked to stop: exit status 1
};

struct Error {
    Cause cause = Cause::input;
    std::string message;  ///< one line per problem, without a trailing newline
};

template <class T>
using Result = tl::expected<T, Error>;
using Status = Result<void>;

/// `return input_error("{}: ...", file);`
template <class... Args>
tl::unexpected<Error> input_error(fmt::format_string<Args...> text, Args&&... args) {
    return tl::unexpected(Error{Cause::input, fmt::format(text, std::forward<Args>(args)...)});
}

template <class... Args>
tl::unexpected<Error> failure(fmt::format_string<Args...> text, Args&&... args) {
    return tl::unexpected(Error{Cause::failed, fmt::format(text, std::forward<Args>(args)...)});
}

inline tl::unexpected<Error> cancelled() {
    return tl::unexpected(Error{Cause::cancelled, "cancelled"});
}

}  // namespace pliant
