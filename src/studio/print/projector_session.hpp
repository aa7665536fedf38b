// Test patterns on a projector, for its setup from a page: focus, size.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "base/core/error.hpp"
#include "printing/machine/printer.hpp"
#include "printing/screen/projector.hpp"

namespace pliant::studio {

class ProjectorSession {
public:
    struct Order {
        std::string where;    ///< number of a display, or a folder that exists
        std::string pattern;  ///< as host::pattern_names() lists them
        int square_px = 1;    ///< of the checkerboard
        double seconds = 0;   ///< above 0, at most `longest_s`; after this time the projector turns dark
    };
    static constexpr double longest_s = 600;

    /// Shows a pattern of the printer's size, replacing the previous one. Errors: no such pattern or display, a display
    /// of another size or in use by a print.
    [[nodiscard]] Status show(const Order& order, const machine::Projector& projector);
    /// Turns dark and releases the projector, so that a print may use it. No effect if there is none.
    void dark();

private:
    std::mutex mutex_;
    std::unique_ptr<host::ScreenProjector> screen_;
    std::string where_;
};

/// The pattern as a picture, PNG. Errors: no such pattern.
[[nodiscard]] Result<std::string> pattern_picture(const std::string& pattern, int square_px,
                                                  const machine::Projector& projector);

}  // namespace pliant::studio
