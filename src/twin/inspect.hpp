// The oracle: is what cured in the virtual printer the part that the job asked for?
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "job/job.hpp"
#include "twin/trapped.hpp"
#include "twin/twin.hpp"

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
    double tolerance_mm3 = 0;  ///< between model and cured: 1 % and one pixel layer (surface times half a pixel)
    bool passed = false;
};

struct ResinReport {
    std::string name;
    double cured_mm3 = 0;
    double left_ml = 0;
    double foreign_share = 0;  ///< of what is left, in the end
    double overcure_mm3 = 0;   ///< cured below ceilings where no image asks for it
};

struct Report {
    bool passed = false;
    std::vector<std::string> reasons;  ///< why not, one line each
    std::vector<MaterialReport> materials;
    std::vector<ResinReport> resins;  ///< one for each vat
    int layers = 0;                   ///< cured
    int missing_layers = 0;           ///< that the job asks for and that are not there
    int stray_layers = 0;             ///< at a height where the job has none
    int wrong_thickness = 0;          ///< layers thicker or thinner than the job's
    long wrong_pixels = 0;            ///< that cured more or less of a resin than the images ask for
    long pixels_lit_twice = 0;        ///< other than those that the job asks for
    std::string first_deviation;      ///< layer, material, what and by which step; "" if the print passed
    int contaminated_layers = 0;
    double worst_foreign = 0;  ///< share of foreign resin in a vat that printed
    double worst_residue = 0;  ///< share of the film that a cleaning left
    double deepest_overcure_um = 0;
    std::vector<Contamination> contamination;  ///< layer by layer
    std::vector<Trapped> trapped;              ///< liquid that stays in the part, largest first
    Log log;
    double clock_s = 0;
};

/// Compares the cured block with the job, pixel by pixel and by volume. The part passes if every layer is there at its
/// height and thickness, every pixel holds what its images say (light seen through the projector's mask and the resin's
/// grey, see Screen), the volume of every material agrees with the model's and with the areas that the job states, and
/// nothing happened on the way that must not. Fails (as an error) only if an image cannot be had.
[[nodiscard]] Result<Report> inspect(Twin& twin, const job::Manifest& job, const ImageSource& images);
[[nodiscard]] Result<Report> inspect(Twin& twin, const job::Manifest& job, const RunSource& images);

[[nodiscard]] std::string report_json(const Report& report);
[[nodiscard]] std::string report_text(const Report& report);

}  // namespace pliant::twin
