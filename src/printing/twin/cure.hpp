// From light to solid: which resin cured where, layer by layer, and what is left in the vats.
//
// The model (Jacobs' working curve): a dose E cures to the depth Dp ln(E / Ec), with Dp the resin's depth of
// penetration and Ec its critical dose. A layer bonds to what is above it if the depth reaches across the gap between
// the platform's height and the top of the part; otherwise it is lost. Light that goes deeper cures the solid further
// and, under an overhang, resin that should stay liquid: overcure, summed over all layers that send light through that
// underside.
//
// A pixel's grey value v is the fraction of its area inside the body (the meaning of anti-aliased edges), so a cured
// pixel counts as v/255 of its volume; it is not read as a weaker dose. The cured layer is as thick as the gap, so a
// wrong height shows.
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

/// Exposure of one image from one vat on one layer, in one piece or several: doses add up.
struct Lit {
    Runs light;
    double seconds = 0;
    int pieces = 1;
};

/// What cured from one vat on one layer.
struct VatLayer {
    int vat = 0;  ///< index into Printer::vats
    Runs runs;    ///< values above 255 only if different images exposed a pixel
    std::vector<Lit> lit;
};

struct CuredLayer {
    int top_um = 0;
    int thickness_um = 0;
    std::vector<VatLayer> vats;
};

/// How deep below an underside of the images a resin may cure: one `cure_depth`, the resolution at which a layer-wise
/// print can place an underside, plus what bleed compensation removed from the images there.
[[nodiscard]] double allowed_overcure_um(const machine::Resin& resin);

/// Whether the block is kept, which takes memory for all runs of all layers, or only what is counted.
enum class Keep { layers, counts };

class Cure {
public:
    explicit Cure(const machine::Printer& printer, Keep keep = Keep::layers);

    /// One exposure with a vat and the platform at `z_um`; light through an image of the projector's size. The same
    /// image again on the same layer continues the previous exposure: their doses add up.
    void expose(const Runs& light, int vat, double seconds, int z_um);
    void expose(const job::Image& image, int vat, double seconds, int z_um) {
        expose(runs_of(image), vat, seconds, z_um);
    }
    /// Closes the current layer; call before reading the block.
    void finish();
    /// Removes the part; the vats keep their content.
    void clear();
    /// Resin that leaves a vat (negative: enters) other than by curing.
    void take_ml(int vat, double ml) { left_ml_[static_cast<std::size_t>(vat)] -= ml; }
    void set_level_ml(int vat, double ml) { left_ml_[static_cast<std::size_t>(vat)] = ml; }

    /// Empty with Keep::counts.
    [[nodiscard]] const std::vector<CuredLayer>& layers() const { return layers_; }
    /// The layer after these as far as it has cured, without closing it; nullopt: none has begun.
    [[nodiscard]] std::optional<CuredLayer> open_layer() const;
    /// Number of different exposures that it has had.
    [[nodiscard]] std::size_t open_lights() const;
    [[nodiscard]] const std::vector<double>& left_ml() const { return left_ml_; }  ///< by vat
    [[nodiscard]] long pixels_lit_twice() const { return pixels_lit_twice_; }
    /// Volume cured below undersides that no image asks for, and its maximum depth; by vat. Up to finish().
    [[nodiscard]] const std::vector<double>& overcure_mm3() const { return overcure_mm3_; }
    [[nodiscard]] double deepest_overcure_um() const { return deepest_overcure_um_; }
    /// The part of it that is deeper than allowed, by vat; see allowed_overcure_um.
    [[nodiscard]] const std::vector<double>& overcure_beyond_mm3() const { return overcure_beyond_mm3_; }
    struct Place {
        int row = 0, column = 0;
        int z_um = 0;  ///< of the underside
    };
    /// The place of the deepest overcure.
    [[nodiscard]] const Place& deepest_overcure() const { return deepest_; }
    /// The area that a resin film adheres to, in mm^2: the lower end of the part. It is the area cured in the current
    /// layer or, while that is smaller, in the layer before.
    [[nodiscard]] double section_mm2() const { return std::max(section_mm2_, section_before_mm2_); }
    /// Faults of the exposures, one line each.
    [[nodiscard]] const std::vector<std::string>& faults() const { return faults_; }

private:
    struct OpenLayer {
        int top_um = 0;
        int thickness_um = 0;
        std::vector<std::vector<Lit>> lit;  ///< by vat
    };
    /// An exposure that has cured nothing yet, but may be continued.
    struct Faint {
        Lit lit;
        int vat = 0;
        int z_um = 0;
        std::string why;
    };
    /// The lowest solid stack of a column of pixels: the ceiling of the free space below it.
    struct Column {
        std::int32_t bottom_um = 0;  ///< the side printed first, away from the window
        std::int32_t top_um = 0;     ///< the side printed last; 0: the platform itself
        std::int32_t free_um = 0;    ///< height of liquid resin between `bottom_um` and the solid above it
        float dose_J_m2 = 0;         ///< accumulated at `bottom_um`
        std::int16_t vat = 0;        ///< that last exposed the ceiling
    };
    /// Columns of one row, from that of pixel `begin` on: those that light has reached, and some beside them.
    struct Strip {
        int begin = 0;
        std::vector<Column> columns;

        /// Makes it hold the pixels [from, to).
        void reach(int from, int to);
    };
    [[nodiscard]] std::string why_not(int vat, double seconds, int z_um, double area_mm2) const;
    [[nodiscard]] Lit* lit_before(const Runs& light, int vat, int z_um);
    void fault(std::string text);
    void give_up_faint();
    void open(int z_um);
    void shine_through(const Runs& light, int vat, double dose_J_m2);
    void add_dose(Column& column, int row, int at, double dose_J_m2);
    [[nodiscard]] CuredLayer closed(OpenLayer ended) const;
    [[nodiscard]] double overcure_um(const Column& column) const;
    void count_double(const OpenLayer& layer);
    [[nodiscard]] double pixel_mm2() const;

    const machine::Printer* printer_;
    Keep keep_;
    std::vector<WorkingCurve> curves_;  ///< by vat
    std::vector<double> allowed_um_;    ///< by vat: allowed overcure
    std::optional<OpenLayer> open_;
    std::optional<Faint> faint_;
    int top_um_ = 0;  ///< of the part
    std::vector<CuredLayer> layers_;
    std::vector<Strip> strips_;  ///< by row; empty until the first exposure
    std::vector<double> left_ml_;
    std::vector<double> overcure_mm3_, overcure_beyond_mm3_;
    double deepest_overcure_um_ = 0;
    Place deepest_;
    double section_mm2_ = 0, section_before_mm2_ = 0;  ///< of the last layer and the one before it
    long pixels_lit_twice_ = 0;
    std::vector<std::string> faults_;
};

}  // namespace pliant::twin
