// What a program does between two lights, measured as the machine will do it: how far it lifts, how long it rests,
// cleans and dries.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/brush.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/check.hpp"

namespace pliant::plan {

/// Measures steps of a program against what the printer file asks for. The printer must outlive it.
class Passage {
public:
    explicit Passage(const machine::Printer& printer)
        : printer_(&printer), fan_on_(printer.fans.size()), brush_(printer) {}

    /// Begins anew at a light at `z_um`; fans keep running.
    void restart(int z_um);
    void add(const Step& step);

    /// Before a light at `z_um`: a slow way down into the resin, and a rest.
    [[nodiscard]] Status check_approach(int z_um) const;
    /// After a light at `z_um`: a rest until the projector is dark, the shear stroke, the lift that peels.
    [[nodiscard]] Status check_peel(int z_um) const;
    /// The part was cleaned for `seconds` with the motion that the file asks for, and dried.
    [[nodiscard]] Status check_cleaning(double seconds) const;
    /// Whether a brush, where there is one, has wiped the part while its vat was put away.
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
    int light_um_ = 0;  ///< height of the light before
    bool moved_ = false;
    double rest_after_light_s_ = 0;  ///< until the first move
    double rest_s_ = 0;              ///< since the last move
    int top_um_ = 0;                 ///< of the platform
    int sheared_um_ = 0;             ///< how far the carriage went aside at the height of the light
    int fast_down_to_um_ = 0;        ///< lowest end of a way down into the vat above the speed of approach
    int fast_up_from_um_ = 0;        ///< lowest start of a way up out of the vat above the speed of the lift
    bool went_down_fast_ = false, went_up_fast_ = false;
    double cleaned_s_ = 0;  ///< all of the cleaning: strokes, rests and other moves
    double still_s_ = 0;    ///< of it: neither strokes nor moves of the store
    double stroke_s_ = 0;   ///< of it: strokes as far and as fast as asked for
    int strokes_ = 0;
    double dried_s_ = 0;
    machine::BrushWatch brush_;
};

}  // namespace pliant::plan
