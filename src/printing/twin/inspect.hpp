// The oracle: is what cured in the virtual printer the part that the job asked for?
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

/// The image of a layer and a material (indices into the manifest); asked for listed images only.
using ImageSource = std::function<Result<job::Image>(int layer, int material)>;

/// The same as runs; for callers that have seen the images before.
using RunSource = std::function<Result<Runs>(int layer, int material)>;

struct MaterialReport {
    std::string name;
    std::string resin;
    double model_mm3 = 0;   ///< as drawn; of a job that changed outlines on purpose, asked_mm3; 0: the job does not say
    double asked_mm3 = 0;   ///< by the areas that the job states
    double wanted_mm3 = 0;  ///< by the job's images, on this projector
    double cured_mm3 = 0;   ///< of that, in the right resin
    double foreign_mm3 = 0;    ///< of that, in another resin
    double missing_mm3 = 0;    ///< of that, not at all
    double tolerance_mm3 = 0;  ///< between model and cured, see volume_tolerance_mm3
    bool passed = false;
};

struct ResinReport {
    std::string name;
    double cured_mm3 = 0;
    double left_ml = 0;
    double foreign_share = 0;        ///< of what is left, in the end
    double overcure_mm3 = 0;         ///< cured below ceilings where no image asks for it
    double overcure_beyond_mm3 = 0;  ///< of that, deeper than `allowed_overcure_um`
    double allowed_overcure_um = 0;
};

/// What the caller makes of the print.
struct Judgement {
    std::vector<Finding::Kind> accepted;  ///< findings that are told, and do not fail it
    double light_slack_s = 0.01;          ///< how well the clock knows the length of a light
};

struct Report {
    bool passed = false;
    std::vector<Finding> findings;     ///< what is not as it should be
    std::vector<std::string> reasons;  ///< why it did not pass: those that are not accepted, one line each
    std::vector<MaterialReport> materials;
    std::vector<ResinReport> resins;       ///< one for each vat
    int layers = 0;                        ///< cured
    int missing_layers = 0;                ///< that the job asks for and that are not there
    int stray_layers = 0;                  ///< at a height where the job has none
    int wrong_thickness = 0;               ///< layers thicker or thinner than the job's
    long wrong_pixels = 0;                 ///< that cured more or less of a resin than the images ask for
    long missing_pixels = 0;               ///< of those: less of a resin than asked, and no other there
    long foreign_pixels = 0;               ///< of those: less than asked, and another resin there
    long stray_pixels = 0;                 ///< of those: more than asked, in no other's place
    long wrong_dose_pixels = 0;            ///< as much as asked, but lit longer or shorter than the job says
    double least_dose = 1, most_dose = 1;  ///< share of the asked time, of those
    int wrong_images = 0;                  ///< that have not the area which the manifest states
    long pixels_lit_twice = 0;             ///< by different pictures, other than those that the job asks for
    std::string first_deviation;           ///< layer, material, what and by which step; "" if the print passed
    int contaminated_layers = 0;
    double worst_foreign = 0;  ///< share of foreign resin in a vat that printed
    double worst_residue = 0;  ///< share of the film that a cleaning left
    double deepest_overcure_um = 0;
    Cure::Place deepest_overcure;
    std::vector<Contamination> contamination;  ///< layer by layer
    std::vector<Trapped> trapped;              ///< liquid that stays in the part, largest first
    Log log;
    double clock_s = 0;
    double washed_ml = 0, brushed_ml = 0;  ///< resin off the part: into the solution, and back into its vats
    double solution_pumped_ml = 0, solution_used_ml = 0;
    double solution_ml = 0;           ///< in the reservoir in the end; 0: the machine has none
    double solution_resin_share = 0;  ///< of that, resin
};

/// How far sideways an exact slicer may put a border: the rounding of grey values, half a pixel of black and white
/// images, and between materials a gap that is closed.
[[nodiscard]] double border_error_um(double pixel_um, bool grey, bool several_materials);

/// How far the volume of a material in layers of at most `layer_um` may be from its model's of `area_mm2` of surface,
/// whatever its shape: docs/theory.md, "Tolerances of the virtual printer".
[[nodiscard]] double volume_tolerance_mm3(double area_mm2, double border_um, double layer_um);

/// Compares the cured block with the job, voxel by voxel and by volume. The part passes if every layer is there at its
/// height and thickness, every pixel holds what its images say (light seen through the projector's mask and the resin's
/// grey, see Screen) and was lit as long as the manifest says, every image has the area that the manifest states, the
/// volume of every material agrees with the model's, nothing cured deeper below undersides than the drawing allows, and
/// nothing happened on the way that must not. Fails (as an error) only if an image cannot be had.
[[nodiscard]] Result<Report> inspect(Twin& twin, const job::Manifest& job, const ImageSource& images,
                                     const Judgement& judgement = {});
[[nodiscard]] Result<Report> inspect(Twin& twin, const job::Manifest& job, const RunSource& images,
                                     const Judgement& judgement = {});

[[nodiscard]] std::string report_json(const Report& report);
[[nodiscard]] std::string report_text(const Report& report);

}  // namespace pliant::twin
