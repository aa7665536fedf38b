// What a program does between two exposures, measured as the machine will do it: lift, waiting, cleaning and drying.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/brush.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/check.hpp"

namespace pliant::plan {

/// Checks the steps of a program against the requirements of the printer file. The printer must outlive it.
class Passage {
public:
    explicit Passage(const machine::Printer& printer)
        : printer_(&printer), fan_on_(printer.fans.size()), brush_(printer) {}

    /// Restarts at an exposure at `z_um`; fans keep running.
    void restart(int z_um);
    void add(const Step& step);

    /// Before an exposure at `z_um`: slow approach into the resin, and waiting.
    [[nodiscard]] Status check_approach(int z_um) const;
    /// After an exposure at `z_um`: waiting until the projector is dark, the shear stroke, the peel lift.
    [[nodiscard]] Status check_peel(int z_um) const;
    /// The part was cleaned for `seconds` with the motion that the file requires, and dried.
    [[nodiscard]] Status check_cleaning(double seconds) const;
    /// The brush, if any, wiped the part while its vat was put away.
    [[nodiscard]] Status check_brush() const;
    [[nodiscard]] bool fans_run() const;

private:
    void add_move(const Step& step);
    void add_vat_move(const Step& step, double platform_mm_s);
    void add_cleaning(const Step& step);
    [[nodiscard]] bool cleans(const Step& step) const;
    [[nodiscard]] bool asks_for_strokes() const;
    [[nodiscard]] Status check_strokes() const;

    const machine::Printer* printer_;
    std::vector<bool> fan_on_;
    int light_um_ = 0;  ///< height of the previous exposure
    bool moved_ = false;
    double rest_after_light_s_ = 0;  ///< before the first move
    double rest_s_ = 0;              ///< since the last move
    int top_um_ = 0;                 ///< of the platform
    int sheared_um_ = 0;             ///< how far the carriage moved sideways at the height of the exposure
    int fast_down_to_um_ = 0;        ///< lowest end of a downward move into the vat faster than the approach speed
    int fast_up_from_um_ = 0;        ///< lowest start of an upward move out of the vat faster than the lift speed
    bool went_down_fast_ = false, went_up_fast_ = false;
    double cleaned_s_ = 0;  ///< whole cleaning: strokes, waiting and other moves
    double still_s_ = 0;    ///< part of it without strokes or moves of the store
    double stroke_s_ = 0;   ///< part of it with strokes as long and as fast as required
    int strokes_ = 0;
    double dried_s_ = 0;
    machine::BrushWatch brush_;
};

}  // namespace pliant::plan
