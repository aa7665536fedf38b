// Progress of drawing the pictures of a results folder.
#pragma once

#include <exception>
#include <functional>
#include <string_view>

#include "base/core/progress.hpp"

namespace pliant::library {

/// Drawing stops early once the caller has enough pictures. An exception of the caller ends it too, and is thrown again
/// by rethrow(): results are written whole or not at all.
class Drawing final : public Progress {
public:
    /// Both must outlive it.
    Drawing(Progress& shown, const std::function<bool()>& enough) : shown_(shown), enough_(enough) {}
    void advance(std::string_view stage, double fraction) override { shown_.advance(stage, fraction); }
    [[nodiscard]] bool cancelled() const override { return has_enough() || shown_.cancelled(); }
    [[nodiscard]] bool failed() const { return thrown_ != nullptr; }
    void rethrow() const {
        if (thrown_) std::rethrow_exception(thrown_);
    }

private:
    [[nodiscard]] bool has_enough() const {
        if (thrown_) return true;
        try {
            return enough_ && enough_();
        } catch (...) {
            thrown_ = std::current_exception();
        }
        return true;
    }

    Progress& shown_;
    const std::function<bool()>& enough_;
    mutable std::exception_ptr thrown_;
};

}  // namespace pliant::library
