// Whether the brush of a vat has wiped the part: the vat went into the tower with the part as low as the brush reaches
// (thesis, 4.3.2).
#pragma once

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// Watches the moves of a machine from the moment that a vat lies under the platform. The printer must outlive it.
class BrushWatch {
public:
    explicit BrushWatch(const Printer& printer) : printer_(&printer) {}

    /// One move, and how far the part reaches below the platform. Pushes may come in several moves.
    void move(const Position& from, const Position& to, int part_height_um);
    void reset() { *this = BrushWatch(*printer_); }

    /// The vat has gone all the way from the platform to the tower, the part never above the brush's reach.
    [[nodiscard]] bool wiped() const;
    /// How far above the vat's rim the part was at most during that way, in micrometres.
    [[nodiscard]] int highest_um() const { return highest_um_; }

private:
    const Printer* printer_;
    bool left_ = false;     ///< the vat has left the platform
    bool arrived_ = false;  ///< and has come into the tower
    int highest_um_ = 0;
};

}  // namespace pliant::machine
