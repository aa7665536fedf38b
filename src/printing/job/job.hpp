// The job: everything the printer needs, in one zip file. docs/reference/job.md describes the format.
//
//   manifest.json     what is in the archive (this Manifest)
//   layers/00012_soft.png   8-bit grey image of layer 12 of material "soft"; blank images are not stored
//   printer.toml      the printer file that the job was made for
//   plan.json, job.gcode    written by the planner
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/slice/run_image.hpp"

namespace pliant::job {

/// The name of the projector's mask in a job, whatever its name beside the printer file.
inline constexpr const char* mask_entry = "mask.png";

using Image = slice::Image;

/// A drawn material that is printed together with others as one.
struct MaterialPart {
    std::string name;
    double model_volume_mm3 = 0, model_area_mm2 = 0;
};

struct Material {
    std::string name;   ///< as in the robot file; unique
    std::string resin;  ///< the resin a printer's vat holds
    double model_volume_mm3 =
        0;  ///< of the bodies as drawn, without overlaps assigned to others, for comparison after the print
    double model_area_mm2 = 0;           ///< of their surface: one pixel layer around it is the possible rasterisation
                                         ///< error
    double exposure_s = 0;               ///< of a normal layer
    double bottom_exposure_s = 0;        ///< of the first layers: bottom_layers()
    std::vector<MaterialPart> parts{};   ///< two or more drawn materials with the same resin and exposure; empty: a
                                         ///< single one
    std::string colour{};                ///< "#rrggbb", in which it is shown; "": none was chosen
    std::optional<int> bottom_layers{};  ///< of this material; nothing: as many as the manifest says
};

/// One image that is not blank.
struct LayerImage {
    int material = 0;       ///< index into Manifest::materials
    std::string file;       ///< name inside the archive
    double area_mm2 = 0;    ///< sum of pixel values / 255 times the pixel's area
    double exposure_s = 0;  ///< of this image; 0: the material's exposure
    double shared_mm2 = 0;  ///< part of `area_mm2` that images of other materials expose too, for bonding
};

struct Layer {
    int z_um = 0;  ///< height of the layer's top above the platform
    int thickness_um = 0;
    std::vector<LayerImage> images;  ///< ordered by material; empty if nothing is printed
};

/// A possible printing problem, and where it is.
struct Finding {
    std::string kind;  ///< "island", "trap", "cup" or "thin"
    int first_layer = 0, last_layer = 0;
    int row = 0, column = 0;  ///< a pixel of the problem, in `first_layer`
    double area_mm2 = 0;      ///< of an island or a thin feature in `first_layer`
    double volume_mm3 = 0;    ///< of a trap or a cup
    std::string picture;      ///< PNG inside the archive; "": none
    std::string severity;     ///< "high", "medium" or "low"; "": not rated
    int count = 1;            ///< number of islands it stands for: those that grow together, or all of low severity
};

struct Manifest {
    std::string name;
    std::string pliant_version;
    int width_px = 0, height_px = 0;
    double pixel_um = 0;    ///< edge length of a (square) pixel on the platform
    int bottom_layers = 0;  ///< layers with the bottom exposure, of materials that have no number of their own
    std::vector<Material> materials;
    std::vector<Layer> layers;
    std::vector<std::string> warnings;  ///< repairs and remarks of the slicer
    bool compensated = false;           ///< images differ from the drawing on purpose
    std::vector<Finding> findings{};
    bool any_vat = false;  ///< a resin without a vat may be filled into any vat
    /// SHA-256 (64 hex digits) of every entry but the manifest; empty: a job of format 1, which has none.
    std::map<std::string, std::string> sha256{};
};

/// How many layers from the platform up have the bottom exposure of a material.
[[nodiscard]] inline int bottom_layers(const Manifest& manifest, const Material& material) {
    return material.bottom_layers.value_or(manifest.bottom_layers);
}

/// Exposure of image `index` of a layer.
[[nodiscard]] inline double exposure_s(const Manifest& manifest, std::size_t layer, std::size_t index) {
    const LayerImage& image = manifest.layers[layer].images[index];
    if (image.exposure_s > 0) return image.exposure_s;
    const Material& m = manifest.materials[static_cast<std::size_t>(image.material)];
    return static_cast<int>(layer) < bottom_layers(manifest, m) ? m.bottom_exposure_s : m.exposure_s;
}

/// Checks the consistency of a manifest. Errors: sizes and numbers out of range, a material without a name or named
/// twice, heights that do not ascend, an image of a missing material or two of one material in a layer, file names that
/// are not plain relative paths. The message starts with `where`.
[[nodiscard]] Status check(const Manifest& manifest, std::string_view where);

/// The thumbnail of the part, 400 by 400 pixels.
inline constexpr const char* thumbnail_file = "thumbnail.png";

/// "layers/00012_soft.png"; characters of the material's name other than letters, digits, '-' and '_' become '_'.
[[nodiscard]] std::string image_file_name(int layer, std::string_view material);

/// An image as a PNG file, with its size.
struct EncodedImage {
    int width_px = 0;
    int height_px = 0;
    std::string png;
};

/// 8-bit grey PNG, not interlaced; optimised for speed, not size. Thread-safe. Precondition: at least one pixel, and as
/// many values as pixels.
[[nodiscard]] EncodedImage encode(const Image& image);
[[nodiscard]] EncodedImage encode(const slice::RunImage& image);

/// Writes a job as PATH.partial; finish() renames it, and without finish() nothing is left behind. The same calls give
/// the same bytes. Images are written to disk as they come.
class Writer {
public:
    /// Errors: the folder does not exist, PATH is a folder.
    [[nodiscard]] static Result<Writer> create(const std::filesystem::path& path);
    Writer(Writer&&) noexcept;
    Writer& operator=(Writer&&) noexcept;
    ~Writer();

    /// Adds an image; `file` as in LayerImage. Errors: an unsafe or duplicate name, an image without pixels or with a
    /// wrong number of values.
    [[nodiscard]] Status add_image(const std::string& file, const Image& image);
    [[nodiscard]] Status add_image(const std::string& file, EncodedImage image);
    /// Adds any other file, deflated. Errors as above.
    [[nodiscard]] Status add_file(const std::string& file, std::string_view bytes);
    /// Adds the manifest with the hashes of all entries, writes everything and renames. Errors: check(), an image that
    /// was not added or whose size differs from the manifest's, the disk. The writer cannot be used afterwards.
    [[nodiscard]] Status finish(const Manifest& manifest);

private:
    struct State;
    explicit Writer(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// A job, opened and validated: every image that the manifest lists exists, indices and sizes agree. Untrusted archives
/// are safe to open: sizes are checked before memory is allocated. Errors name archive and entry. Not thread-safe.
class Archive {
public:
    [[nodiscard]] static Result<Archive> open(const std::filesystem::path& path);
    Archive(Archive&&) noexcept;
    Archive& operator=(Archive&&) noexcept;
    ~Archive();

    [[nodiscard]] const Manifest& manifest() const;
    [[nodiscard]] bool has_file(const std::string& file) const;
    /// The bytes of an entry of at most 1 GB. Errors: their hash differs from the manifest's, or the manifest has
    /// hashes but none for this entry.
    [[nodiscard]] Result<std::string> file(const std::string& file) const;
    /// Decodes an image; its size is that of the manifest.
    [[nodiscard]] Result<Image> image(const std::string& file) const;
    /// The same into an image that is there, whose memory is used again: for one image after the other.
    [[nodiscard]] Status image(const std::string& file, Image& into) const;

private:
    struct State;
    explicit Archive(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// Whether a file is a job, valid or not: a zip file whose manifest.json states a format.
[[nodiscard]] bool is_job(const std::filesystem::path& path);

}  // namespace pliant::job
