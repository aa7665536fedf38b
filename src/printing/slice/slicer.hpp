// From bodies to per-material layer images.
//
//     auto warnings = place_on_platform(bodies, raster);             // centred, lowered to z = 0
//     auto slicer = Slicer::prepare(bodies, {.raster = raster, .layer_um = 50});
//     const SlicedLayer layer = slicer->layer(12);                    // from any thread
//
// or slice_bodies() for all layers in order.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "printing/slice/body.hpp"
#include "printing/slice/bond.hpp"
#include "printing/slice/compensate.hpp"
#include "printing/slice/compose.hpp"
#include "printing/slice/layers.hpp"
#include "printing/slice/outline_stack.hpp"
#include "printing/slice/overlap.hpp"
#include "printing/slice/removal.hpp"
#include "printing/slice/run_image.hpp"
#include "printing/slice/section.hpp"
#include "printing/slice/teeth.hpp"

namespace pliant::slice {

struct Settings {
    Raster raster;
    int layer_um = 50;
    ComposeRules rules;
    std::map<std::string, Compensation> compensation{};  ///< by material; others are not compensated
    std::vector<Teeth> teeth{};                          ///< applied in order, after compensation
    std::vector<Bond> bonds{};                           ///< applied after teeth
    std::vector<int> tops_um{};                ///< of non-uniform layers, ascending; if empty, all are `layer_um` thick
    std::shared_ptr<const Removal> removed{};  ///< inside the part; null: nothing

    [[nodiscard]] Layers layers() const { return tops_um.empty() ? Layers(layer_um) : Layers(tops_um); }
};

/// One layer: its non-blank images, ordered by material, and remarks on it.
using SlicedLayer = ComposedLayer;

/// Of a repaired body as drawn, before rasterisation.
struct Measures {
    double volume_mm3 = 0;  ///< with what is cut out of it
    double area_mm2 = 0;    ///< with that of the air
};

/// Repaired bodies, ready for slicing; immutable.
class Slicer {
public:
    /// `bodies` in order of priority: where bodies overlap, the later one keeps the place. Errors name the body: what
    /// repair() rejects, bodies outside the raster or more than 1 um below the platform, nothing to print.
    [[nodiscard]] static Result<Slicer> prepare(std::span<const Body> bodies, const Settings& settings);

    [[nodiscard]] int layer_count() const { return layer_count_; }
    [[nodiscard]] const Settings& settings() const { return settings_; }
    /// In the order in which the bodies first name them.
    [[nodiscard]] const std::vector<std::string>& materials() const { return materials_; }
    /// Repairs made, and bodies too small to appear.
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
    /// Names in messages, "body 'finger' (soft)".
    [[nodiscard]] const std::vector<std::string>& body_labels() const { return labels_; }

    /// Per body.
    [[nodiscard]] const std::vector<Measures>& measures() const { return measures_; }
    [[nodiscard]] const std::vector<bool>& fillers() const { return fillers_; }
    /// Of each body: overlap with later ones up to this comes from the chords of common faces.
    [[nodiscard]] const std::vector<double>& residues_mm3() const { return residues_mm3_; }

    [[nodiscard]] const Layers& layers() const { return layers_; }

    /// Layer k is cut in its middle; 0 <= k < layer_count(). Thread-safe. Cost: the pixels that outlines pass through;
    /// with bleed compensation or bonds over layers, those of neighbouring layers too.
    [[nodiscard]] SlicedLayer layer(int k) const;

private:
    Slicer() = default;
    Status add_body(const Body& body, const std::string& label);
    void add_shape(const Body& body, const Vec3& size_um);
    void section(std::size_t body, int layer, std::vector<Segment>& segments) const;
    enum class Foot { drawn, left_out };  ///< the ring of the first layers that an elephant foot would fill
    [[nodiscard]] Overlap cut_air(std::size_t body, int layer, const Raster& raster, std::vector<Segment>& lines) const;
    [[nodiscard]] std::vector<double> offsets_um(int layer, Foot foot) const;
    [[nodiscard]] int material(const std::string& name) const;
    [[nodiscard]] Status check_pairs() const;
    [[nodiscard]] Status check_pair(const char* what, const std::string& first, const std::string& second) const;
    int add_material(const std::string& name);
    int add_zone(const Body& body);
    void deal_out(int layer, ComposedLayer& composed) const;
    void take_out(int layer, ComposedLayer& composed) const;
    [[nodiscard]] int bleed_layers(int material, int layer) const;
    [[nodiscard]] ComposedLayer owned(int layer, Foot foot) const;
    [[nodiscard]] ComposedLayer bled(int layer) const;
    [[nodiscard]] ComposedLayer outlined(int layer, Foot foot) const;
    [[nodiscard]] ComposedLayer composed(int layer, const Raster& raster, const ComposeRules& rules) const;

    Settings settings_;
    Layers layers_ = 1;
    std::vector<std::variant<Sectioner, OutlineStack>> shapes_;  ///< per body
    std::vector<std::vector<Sectioner>> air_;                    ///< per body, cut out of it
    /// Bodies rasterised together: all of one material without blend, or a single one with a blend.
    struct Zone {
        int material = 0;
        int second = -1;  ///< second material of the blend
        int body = 0;     ///< the first body
        std::optional<Blend> blend;
    };
    std::vector<Zone> zones_;
    std::vector<int> zone_of_, material_of_;  ///< per body
    std::vector<Measures> measures_;          ///< per body
    std::vector<bool> fillers_;               ///< per body
    std::vector<double> residues_mm3_;        ///< per body
    std::vector<std::string> materials_, labels_, warnings_;
    int layer_count_ = 0;
};

struct Summary {
    int layer_count = 0;
    std::vector<std::string> materials;
    double overlap_mm3 = 0;              ///< volume claimed by bodies of different materials
    std::int64_t closed_gap_pixels = 0;  ///< pixels that gaps between materials would have darkened
    std::vector<std::string> warnings;
    std::vector<double> lost_mm3{};      ///< per body: its share of overlap_mm3, kept by a later body
    std::vector<double> second_share{};  ///< per body: fraction of its light that went to the second material of its
                                         ///< blend
    std::vector<double> doubled_mm3{};   ///< per body: volume also filled by a later one of the same material, or by
                                         ///< itself again
    std::vector<double> air_mm3{};       ///< per body: volume that was cut out of it
    std::vector<bool> interlocked{};     ///< per interlock: whether it changed a pixel
    std::vector<bool> overlapped{};      ///< per overlap: whether a pixel is exposed twice for it
};

/// Collects the remarks of all layers, which are added in order.
class Tally {
public:
    explicit Tally(const Slicer& slicer);
    void add(int k, const SlicedLayer& layer);
    [[nodiscard]] Summary summary() const;

private:
    const Slicer& slicer_;
    std::vector<double> lost_mm3_, doubled_mm3_, air_mm3_, first_mm3_, second_mm3_;  ///< per body
    std::vector<bool> interlocked_, overlapped_;                                     ///< per pair of the settings
    std::int64_t closed_gap_pixels_ = 0;
    int first_filled_ = -1, last_filled_ = -1, empty_between_ = 0, first_empty_ = -1, pending_empty_ = 0;
};

/// Enough layers to keep all cores busy, few enough to limit memory for their runs.
inline constexpr int layers_at_once = 64;

/// Calls `emit(layer, material, image)` for every non-blank image, by layer and then by material, from the calling
/// thread; layers are made in parallel batches, never all in memory. Stops at the first error of `emit`, or when
/// `progress` is cancelled.
[[nodiscard]] Result<Summary> slice_bodies(std::span<const Body> bodies, const Settings& settings,
                                           const std::function<Status(int layer, int material, const RunImage&)>& emit,
                                           Progress& progress);

}  // namespace pliant::slice
