// Light becomes matter: which resin cured where, layer by layer, and what is left in the vats.
//
// The rule. An exposure cures if the light was on for at least the resin's critical share of its exposure time; a
// shorter one leaves nothing solid. A pixel's grey value v is how much of the pixel's area lies inside the body (that
// is what anti-aliased edges mean), so a cured pixel counts as v/255 of its volume; it is not read as a weaker dose.
// The cured layer is as thick as the gap between the platform's height and the top of the part, so a wrong height
// shows; a gap deeper than the resin cures holds on to nothing and is lost.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "job/job.hpp"
#include "machine/printer.hpp"

namespace pliant::twin {

/// Pixels [begin, end) of one row, all of one value.
struct Run {
    int row = 0;
    int begin = 0, end = 0;
    std::uint16_t value = 0;  ///< sum of the grey values that cured here; above 255 only if lit twice
};

/// What cured from one vat on one layer.
struct VatLayer {
    int vat = 0;  ///< index into Printer::vats
    std::vector<Run> runs;
};

struct CuredLayer {
    int top_um = 0;
    int thickness_um = 0;
    std::vector<VatLayer> vats;
};

class Cure {
public:
    explicit Cure(const machine::Printer& printer);

    /// One exposure with a vat and the platform at `z_um`. `image` has the projector's size.
    void expose(const job::Image& image, int vat, double seconds, int z_um);
    /// Closes the layer that is under way; called before the block is looked at.
    void finish();

    [[nodiscard]] const std::vector<CuredLayer>& layers() const { return layers_; }
    [[nodiscard]] const std::vector<double>& left_ml() const { return left_ml_; }  ///< by vat
    [[nodiscard]] long pixels_lit_twice() const { return pixels_lit_twice_; }
    /// What went wrong with the light, one line each.
    [[nodiscard]] const std::vector<std::string>& faults() const { return faults_; }

private:
    struct OpenLayer {
        int top_um = 0;
        int thickness_um = 0;
        std::vector<std::vector<std::uint16_t>> values;  ///< by vat, (height, width); empty: nothing from that vat
    };
    [[nodiscard]] bool cures(int vat, double seconds, int z_um);
    void open(int z_um);
    void count_double(const OpenLayer& layer);

    const machine::Printer* printer_;
    std::optional<OpenLayer> open_;
    int top_um_ = 0;  ///< of the part
    std::vector<CuredLayer> layers_;
    std::vector<double> left_ml_;
    long pixels_lit_twice_ = 0;
    std::vector<std::string> faults_;
};

}  // namespace pliant::twin
