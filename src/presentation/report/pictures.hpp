// pictures/*.png: the robot at rest, at the end, in between, and its stress, all from one viewpoint.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "presentation/draw/surface.hpp"
#include "presentation/report/simulation.hpp"

namespace pliant::report {

struct Picture {
    std::string file;   ///< "rest.png"
    std::string title;  ///< for people
    std::string png;    ///< the file's bytes
};

struct PictureSize {
    int width_px = 1600;
    int height_px = 1000;
};

enum class PictureSet { none, few, all };

/// The small set is a quick look that takes less processor time than a simulation of seconds: a quarter of the size.
[[nodiscard]] constexpr PictureSize usual_size(PictureSet set) {
    return set == PictureSet::few ? PictureSize{800, 500} : PictureSize{};
}

struct PictureChoice {
    PictureSet set = PictureSet::few;
    PictureSize size = usual_size(set);
    std::optional<Vec3> towards_eye{};  ///< empty: chosen by the robot's motion
    bool film = false;                  ///< also draws film.gif, in its own size
};

/// few: final.png (rest as a ghost, markers with their paths); all: rest.png, final.png, stages.png and von_mises.png.
/// With measured markers, measured.png too. Text and lines scale with the picture.
[[nodiscard]] Result<std::vector<Picture>> draw_pictures(const Simulation& simulation, const Surface& surface,
                                                         const PictureChoice& choice, Progress& progress);

/// Film size: small enough for a page or a slide.
inline constexpr PictureSize usual_film_size{640, 400};

/// The motion of the robot as an animated GIF: all steps or, if there are many, 60 of them, over three seconds, with a
/// pause at the end.
[[nodiscard]] Result<std::string> draw_film(const Simulation& simulation, const Surface& surface,
                                            const PictureChoice& choice, Progress& progress);

/// One line about the state at a step: "step 30 of 30 · flexor 70 %, 71.3 N", or "at rest · ...".
[[nodiscard]] std::string step_line(const Simulation& simulation, std::size_t step);

/// The smallest of 1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten that is not below `value`; 1 for values that
/// are not positive.
[[nodiscard]] double nice_ceiling(double value);

}  // namespace pliant::report
