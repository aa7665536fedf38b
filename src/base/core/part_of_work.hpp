// Progress of a part of some work.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "base/core/progress.hpp"

namespace pliant {

/// Reports its work as the share `from` to `to` of the whole, under one name of a stage.
class PartOfWork final : public Progress {
public:
    PartOfWork(Progress& whole, std::string stage, double from, double to)
        : whole_(whole), stage_(std::move(stage)), from_(from), to_(to) {}
    void advance(std::string_view, double fraction) override {
        whole_.advance(stage_, from_ + (to_ - from_) * fraction);
    }
    [[nodiscard]] bool cancelled() const override { return whole_.cancelled(); }

private:
    Progress& whole_;
    std::string stage_;
    double from_, to_;
};

/// The part `index`, from 0, of `count` equal ones.
[[nodiscard]] inline PartOfWork equal_part(Progress& whole, std::string stage, std::size_t index, std::size_t count) {
    const double share = 1 / static_cast<double>(count);
    return {whole, std::move(stage), share * static_cast<double>(index), share * static_cast<double>(index + 1)};
}

}  // namespace pliant
