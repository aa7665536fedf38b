// Light becomes matter: which resin cured where, layer by layer, and what is left in the vats.
//
// The rule (Jacobs' working curve): a dose E of light cures to the depth Dp ln(E / Ec), Dp the resin's depth of
// penetration, Ec its critical dose. A layer holds on to what is above it if the depth reaches across the gap between
// the platform's height and the top of the part; else it is lost. What reaches further cures again what is solid, and
// where it is not, under an overhang, resin that should have stayed liquid: overcure, summed up over all the layers
// that send light through that ceiling.
//
// A pixel's grey value v is how much of the pixel's area lies inside the body (that is what anti-aliased edges mean),
// so a cured pixel counts as v/255 of its volume; it is not read as a weaker dose. The cured layer is as thick as the
// gap, so a wrong height shows.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/machine/working_curve.hpp"
#include "printing/twin/runs.hpp"

namespace pliant::twin {

using machine::working_curve;
using machine::WorkingCurve;

/// Light of one picture from one vat on one layer, given in one piece or in several: doses add up.
struct Lit {
    Runs light;
    double seconds = 0;
    int pieces = 1;
};

/// What cured from one vat on one layer.
struct VatLayer {
    int vat = 0;  ///< index into Printer::vats
    Runs runs;    ///< values above 255 only if different pictures lit a pixel
    std::vector<Lit> lit;
};

struct CuredLayer {
    int top_um = 0;
    int thickness_um = 0;
    std::vector<VatLayer> vats;
};

/// How deep below an underside of the images a resin may cure: one `cure_depth`, within which a layer-wise print can
/// know an underside at all, and what bleed compensation has left out of the images there.
[[nodiscard]] double allowed_overcure_um(const machine::Resin& resin);

class Cure {
public:
    explicit Cure(const machine::Printer& printer);

    /// One exposure with a vat and the platform at `z_um`; light through an image of the projector's size. The same
    /// light again on the same layer goes on with the one before: their doses add up.
    void expose(const Runs& light, int vat, double seconds, int z_um);
    void expose(const job::Image& image, int vat, double seconds, int z_um) {
        expose(runs_of(image), vat, seconds, z_um);
    }
    /// Closes the layer that is under way; called before the block is looked at.
    void finish();
    /// The part is taken away; what is in the vats stays.
    void clear();
    /// Resin that leaves a vat (negative: comes into it) in another way than by curing.
    void take_ml(int vat, double ml) { left_ml_[static_cast<std::size_t>(vat)] -= ml; }
    void set_level_ml(int vat, double ml) { left_ml_[static_cast<std::size_t>(vat)] = ml; }

    [[nodiscard]] const std::vector<CuredLayer>& layers() const { return layers_; }
    [[nodiscard]] const std::vector<double>& left_ml() const { return left_ml_; }  ///< by vat
    [[nodiscard]] long pixels_lit_twice() const { return pixels_lit_twice_; }
    /// Cured below ceilings though no image asks for it, and the deepest of it; by vat. Up to finish().
    [[nodiscard]] const std::vector<double>& overcure_mm3() const { return overcure_mm3_; }
    [[nodiscard]] double deepest_overcure_um() const { return deepest_overcure_um_; }
    /// Of it what is deeper than a drawing allows, by vat; see allowed_overcure_um.
    [[nodiscard]] const std::vector<double>& overcure_beyond_mm3() const { return overcure_beyond_mm3_; }
    struct Place {
        int row = 0, column = 0;
        int z_um = 0;  ///< of the underside
    };
    /// Where the deepest overcure is.
    [[nodiscard]] const Place& deepest_overcure() const { return deepest_; }
    /// What a film clings to, in mm^2: the lower end of the part. That is what has cured in the layer that is under
    /// way, or, while that is less, the layer before.
    [[nodiscard]] double section_mm2() const { return std::max(section_mm2_, section_before_mm2_); }
    /// What went wrong with the light, one line each.
    [[nodiscard]] const std::vector<std::string>& faults() const { return faults_; }

private:
    struct OpenLayer {
        int top_um = 0;
        int thickness_um = 0;
        std::vector<std::vector<Lit>> lit;  ///< by vat
    };
    /// Light that has cured nothing yet; more of it may.
    struct Faint {
        Lit lit;
        int vat = 0;
        int z_um = 0;
        std::string why;
    };
    /// The lowest solid stack of a column of pixels: a ceiling for what is free beyond it.
    struct Column {
        std::int32_t bottom_um = 0;  ///< the side that was printed first, away from the window
        std::int32_t top_um = 0;     ///< the side that was printed last; 0: the platform itself
        std::int32_t free_um = 0;    ///< resin between `bottom_um` and what is solid above it
        float dose_J_m2 = 0;         ///< that has arrived at `bottom_um`
        std::int16_t vat = 0;        ///< that lit the ceiling
    };
    [[nodiscard]] std::string why_not(int vat, double seconds, int z_um, double area_mm2) const;
    [[nodiscard]] Lit* lit_before(const Runs& light, int vat, int z_um);
    void fault(std::string text);
    void give_up_faint();
    void open(int z_um);
    void shine_through(const Runs& light, int vat, double dose_J_m2);
    void add_dose(Column& column, double dose_J_m2);
    [[nodiscard]] double overcure_um(const Column& column) const;
    void count_double(const OpenLayer& layer);
    [[nodiscard]] double pixel_mm2() const;

    const machine::Printer* printer_;
    std::vector<WorkingCurve> curves_;  ///< by vat
    std::vector<double> allowed_um_;    ///< by vat: overcure
    std::optional<OpenLayer> open_;
    std::optional<Faint> faint_;
    int top_um_ = 0;  ///< of the part
    std::vector<CuredLayer> layers_;
    std::vector<Column> columns_;  ///< (height, width); empty until something is lit
    std::vector<double> left_ml_;
    std::vector<double> overcure_mm3_, overcure_beyond_mm3_;
    double deepest_overcure_um_ = 0;
    Place deepest_;
    double section_mm2_ = 0, section_before_mm2_ = 0;  ///< of the last layer and the one before it
    long pixels_lit_twice_ = 0;
    std::vector<std::string> faults_;
};

}  // namespace pliant::twin
