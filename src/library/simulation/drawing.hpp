// Progress of drawing the pictures of a results folder.
#pragma once

#include <functional>
#include <string_view>

#include "base/core/progress.hpp"

namespace pliant::library {

/// Drawing stops early once the caller has enough pictures.
class Drawing final : public Progress {
public:
    /// Both must outlive it.
    Drawing(Progress& shown, const std::function<bool()>& enough) : shown_(shown), enough_(enough) {}
    void advance(std::string_view stage, double fraction) override { shown_.advance(stage, fraction); }
    [[nodiscard]] bool cancelled() const override { return (enough_ && enough_()) || shown_.cancelled(); }

private:
    Progress& shown_;
    const std::function<bool()>& enough_;
};

}  // namespace pliant::library
