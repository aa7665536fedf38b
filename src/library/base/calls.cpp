#include "library/base/calls.hpp"

#include <fmt/format.h>

#include "base/core/units.hpp"

namespace pliant {

Failure::Failure(Kind kind, const std::string& message, std::string file, int line, std::string key)
    : std::runtime_error(message), kind_(kind), file_(std::move(file)), line_(line), key_(std::move(key)) {}
Failure::~Failure() = default;
Failure::Failure(const Failure&) = default;
Failure& Failure::operator=(const Failure&) = default;

double quantity(std::string_view text, std::string_view unit) {
    static constexpr std::pair<std::string_view, Dimension> dimensions[] = {
        {"m", Dimension::length},     {"s", Dimension::time},     {"N", Dimension::force},
        {"Pa", Dimension::pressure},  {"m^3", Dimension::volume}, {"kg/m^3", Dimension::density},
        {"N/m", Dimension::stiffness}};
    for (const auto& [name, dimension] : dimensions)
        if (name == unit) return library::value_of(parse_quantity(text, dimension));
    throw Failure(Failure::Kind::input,
                  fmt::format("there is no unit \"{}\" here; write m, s, N, Pa, m^3, kg/m^3 or N/m", unit));
}

std::string_view version() noexcept {
    return PLIANT_VERSION;
}

namespace library {
namespace {

Failure::Kind kind_of(Cause cause) {
    switch (cause) {
        case Cause::input:
            return Failure::Kind::input;
        case Cause::failed:
            return Failure::Kind::failed;
        case Cause::cancelled:
            break;
    }
    return Failure::Kind::cancelled;
}

}  // namespace

void fail(const Error& error) {
    if (error.problems.empty()) throw Failure(kind_of(error.cause), error.message);
    const Diagnostic& first = error.problems.front();
    throw Failure(kind_of(error.cause), error.message, first.file, first.line, first.key);
}

void WatchedProgress::advance(std::string_view stage, double fraction) {
    stage_ = stage;
    share_ = fraction;
    ask();
}

bool WatchedProgress::cancelled() const {
    if (std::this_thread::get_id() == thread_) ask();
    return cancelled_;
}

void WatchedProgress::ask() const {
    if (!watch_ || cancelled_) return;
    try {
        cancelled_ = !watch_(stage_, share_);
    } catch (...) {
        thrown_ = std::current_exception();
        cancelled_ = true;
    }
}

void WatchedProgress::rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
}

}  // namespace library
}  // namespace pliant
