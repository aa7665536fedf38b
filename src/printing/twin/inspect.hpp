// Inspection: is what cured in the virtual printer the part that the job describes?
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"
#include "printing/twin/finding.hpp"
#include "printing/twin/trapped.hpp"
#include "printing/twin/twin.hpp"

namespace pliant::twin {

/// The image of a layer and a material (indices into the manifest); called for listed images only.
using ImageSource = std::function<Result<job::Image>(int layer, int material)>;

/// The same as runs; for callers that already have them.
using RunSource = std::function<Result<Runs>(int layer, int material)>;

struct MaterialReport {
    std::string name;
    std::string resin;
    double model_mm3 = 0;      ///< as drawn; for a job with compensated outlines, asked_mm3; 0: not in the job
    double asked_mm3 = 0;      ///< from the areas stated in the job
    double wanted_mm3 = 0;     ///< from the job's images, on this projector
    double cured_mm3 = 0;      ///< of that, in the right resin
    double foreign_mm3 = 0;    ///< of that, in another resin
    double missing_mm3 = 0;    ///< of that, not at all
    double interface_mm3 = 0;  ///< half a pixel along its borders with other materials, whose pixels belong to one only
    double tolerance_mm3 = 0;  ///< allowed difference of model and cured volume: interface and volume_tolerance_mm3
    bool passed = false;
};

struct ResinReport {
    std::string name;
    double cured_mm3 = 0;
    double left_ml = 0;
    double foreign_share = 0;        ///< of the content left at the end
    double overcure_mm3 = 0;         ///< cured below undersides where no image asks for it
    double overcure_beyond_mm3 = 0;  ///< the part of it deeper than `allowed_overcure_um`
    double allowed_overcure_um = 0;
};

/// How the caller wants the print judged.
struct Judgement {
    std::vector<Finding::Kind> accepted;  ///< findings that are reported but do not fail the print
    double light_slack_s = 0.01;          ///< uncertainty of the clock in the length of an exposure
    bool faults_must_occur = false;       ///< an injected fault whose occasion never came fails the print
};

struct Report {
    bool passed = false;
    std::vector<Finding> findings;     ///< all deviations
    std::vector<std::string> reasons;  ///< why it failed: findings that are not accepted, one line each
    std::vector<MaterialReport> materials;
    std::vector<ResinReport> resins;       ///< one per vat
    int layers = 0;                        ///< number of cured layers
    int missing_layers = 0;                ///< in the job, but not printed
    int stray_layers = 0;                  ///< at a height where the job has no layer
    int wrong_thickness = 0;               ///< thicker or thinner than the job's
    long wrong_pixels = 0;                 ///< with more or less cured resin than the images require
    long missing_pixels = 0;               ///< part of these: less of a resin than required, and no other there
    long foreign_pixels = 0;               ///< part of these: less than required, and another resin there
    long stray_pixels = 0;                 ///< part of these: more than required, in no other's place
    long wrong_dose_pixels = 0;            ///< correct resin, but exposed longer or shorter than in the job
    double least_dose = 1, most_dose = 1;  ///< extreme ratios of actual to required exposure, over those
    int wrong_images = 0;                  ///< whose area differs from the manifest's
    long pixels_lit_twice = 0;             ///< by different images, other than those required by the job
    std::string first_deviation;           ///< layer, material, deviation and the step at fault; "" if the print passed
    int contaminated_layers = 0;
    double worst_foreign = 0;  ///< fraction of foreign resin in a vat when used
    double worst_residue = 0;  ///< fraction of the film left by a cleaning
    double deepest_overcure_um = 0;
    Cure::Place deepest_overcure;
    std::vector<Contamination> contamination;  ///< layer by layer
    std::vector<Trapped> trapped;              ///< liquid trapped in the part, largest first
    Log log;
    double clock_s = 0;
    double washed_ml = 0, brushed_ml = 0;  ///< resin removed from the part: into the solution, and back into its vats
    double solution_pumped_ml = 0, solution_used_ml = 0;
    double solution_ml = 0;           ///< in the reservoir at the end; 0: the machine has none
    double solution_resin_share = 0;  ///< fraction of resin in that
};

/// Maximum sideways error of a border in an exact slicer: the rounding of grey values, half a pixel for black and white
/// images, and between materials the width of a closed gap.
[[nodiscard]] double border_error_um(double pixel_um, bool grey, bool several_materials);

/// Tolerance of a material's volume, in layers of at most `layer_um`, against that of its model with `area_mm2` of
/// surface, for any shape: docs/theory.md, "Tolerances of the virtual printer".
[[nodiscard]] double volume_tolerance_mm3(double area_mm2, double border_um, double layer_um);

/// Compares the cured block with the job, voxel by voxel and by volume. The part passes if every layer is present at
/// its height and thickness, every pixel is cured as its images say (light seen through the projector's mask and the
/// resin's grey, see Screen) and was exposed for the time in the manifest, every image has the area stated there, the
/// volume of every material agrees with the model's, nothing cured deeper below undersides than allowed, and nothing
/// forbidden happened. An error only if an image is unavailable.
[[nodiscard]] Result<Report> inspect(Twin& twin, const job::Manifest& job, const ImageSource& images,
                                     const Judgement& judgement = {});
[[nodiscard]] Result<Report> inspect(Twin& twin, const job::Manifest& job, const RunSource& images,
                                     const Judgement& judgement = {});

[[nodiscard]] std::string report_json(const Report& report);
[[nodiscard]] std::string report_text(const Report& report);

}  // namespace pliant::twin
