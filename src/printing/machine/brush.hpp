// Detects whether a vat's brush has wiped the part: the vat went into the tower with the part within reach of the brush
// (thesis, 4.3.2).
#pragma once

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// Follows the machine's moves from the moment a vat is under the platform. The printer must outlive it.
class BrushWatch {
public:
    explicit BrushWatch(const Printer& printer) : printer_(&printer) {}

    /// One move, with the height of the part below the platform. A push may consist of several moves.
    void move(const Position& from, const Position& to, int part_height_um);
    void reset() { *this = BrushWatch(*printer_); }

    /// The vat went all the way from the platform to the tower, with the part always within reach of the brush.
    [[nodiscard]] bool wiped() const;
    /// The part's maximum height above the vat's rim on that way, in micrometres.
    [[nodiscard]] int highest_um() const { return highest_um_; }

private:
    const Printer* printer_;
    bool left_ = false;     ///< the vat has left the platform
    bool arrived_ = false;  ///< and has arrived in the tower
    int highest_um_ = 0;
};

}  // namespace pliant::machine
