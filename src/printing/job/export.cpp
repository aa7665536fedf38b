#include "printing/job/export.hpp"

#include <algorithm>
#include <functional>

#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "base/zip/zip_file.hpp"
#include "printing/job/export_texts.hpp"
#include "printing/job/png.hpp"

namespace pliant::job {
namespace fs = std::filesystem;

namespace {

/// Keeps letters, digits, '-' and '_'; everything else becomes '_'.
std::string file_word(const std::string& text) {
    std::string word;
    for (const char c : text.substr(0, 80)) {
        const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
        word.push_back(plain ? c : '_');
    }
    return word.empty() ? "job" : word;
}

/// Calls `put(layer, png)` for every layer of a material, including blank ones.
Status each_layer(const Archive& archive, int material, Progress& progress,
                  const std::function<Status(std::size_t, std::string)>& put) {
    const Manifest& m = archive.manifest();
    const double parts = static_cast<double>(m.materials.size() * m.layers.size());
    const std::string blank = encode_png(slice::RunImage(m.width_px, m.height_px));
    for (std::size_t k = 0; k < m.layers.size(); ++k) {
        if (progress.cancelled()) return cancelled();
        progress.advance("export",
                         static_cast<double>(static_cast<std::size_t>(material) * m.layers.size() + k) / parts);
        Result<std::string> png = blank;
        for (const LayerImage& image : m.layers[k].images) {
            if (image.material == material) png = archive.file(image.file);
        }
        if (!png) return tl::unexpected(png.error());
        if (auto status = put(k, std::move(*png)); !status) return status;
    }
    return {};
}

std::string image_name(Format format, const std::string& prefix, std::size_t layer) {
    if (format == Format::sl1) return fmt::format("{}{:05}.png", prefix, layer);
    return fmt::format("{}.png", layer + 1);
}

/// The areas of every layer image of a material.
Result<std::vector<ImageAreas>> layer_areas(const Archive& archive, int material, const Progress& progress) {
    const Manifest& m = archive.manifest();
    std::vector<ImageAreas> areas(m.layers.size());
    Image image;
    for (std::size_t k = 0; k < m.layers.size(); ++k) {
        if (progress.cancelled()) return cancelled();
        for (const LayerImage& layer : m.layers[k].images) {
            if (layer.material != material) continue;
            if (Status status = archive.image(layer.file, image); !status) return tl::unexpected(status.error());
            areas[k] = areas_of(image);
        }
    }
    return areas;
}

bool is_even(const Manifest& m) {
    return std::all_of(m.layers.begin(), m.layers.end(),
                       [&](const Layer& layer) { return layer.thickness_um == m.layers[0].thickness_um; });
}

/// The files beside the images.
Result<std::vector<NamedText>> texts_of(const Archive& archive, int material, Format format, const std::string& prefix,
                                        const Progress& progress) {
    const StackFacts facts = facts_of(archive.manifest(), material, prefix);
    if (format == Format::sl1) return sl1_texts(facts);
    if (format == Format::zip) return is_even(archive.manifest()) ? zip_texts(facts) : std::vector<NamedText>{};
    const Result<std::vector<ImageAreas>> areas = layer_areas(archive, material, progress);
    if (!areas) return tl::unexpected(areas.error());
    return nanodlp_texts(facts, *areas);
}

Status fill_stack(const Archive& archive, int material, Format format, ZipWriter& zip, Progress& progress) {
    const std::string prefix = file_word(archive.manifest().name);
    const Result<std::vector<NamedText>> texts = texts_of(archive, material, format, prefix, progress);
    if (!texts) return tl::unexpected(texts.error());
    for (const auto& [name, text] : *texts) {
        if (auto status = zip.add(name, text, ZipWriter::Method::deflate); !status) return status;
    }
    if (format == Format::sl1 && archive.has_file(thumbnail_file)) {
        const Result<std::string> picture = archive.file(thumbnail_file);
        if (!picture) return tl::unexpected(picture.error());
        if (auto status = zip.add("thumbnail/thumbnail400x400.png", *picture, ZipWriter::Method::store); !status)
            return status;
    }
    const Status images = each_layer(archive, material, progress, [&](std::size_t k, std::string png) {
        return zip.add(image_name(format, prefix, k), std::move(png), ZipWriter::Method::store);
    });
    return images ? zip.close() : images;
}

Status write_stack(const Archive& archive, int material, Format format, const fs::path& path, Progress& progress) {
    auto zip = ZipWriter::create(path);
    return zip ? fill_stack(archive, material, format, *zip, progress) : tl::unexpected(zip.error());
}

Status write_vats(const Archive& archive, const fs::path& folder, Progress& progress) {
    const auto count = archive.manifest().materials.size();
    if (count > 26) return input_error("{} materials: vats have the letters a to z", count);
    return write_folder(folder, "vats.txt", [&](const fs::path& inside) -> Status {
        std::string list;
        for (std::size_t m = 0; m < count; ++m) {
            const char letter = static_cast<char>('a' + m);
            const Material& material = archive.manifest().materials[m];
            list += fmt::format("vat_{}: {} in {}\n", letter, material.name, material.resin);
            const fs::path vat = inside / fmt::format("vat_{}", letter);
            std::error_code code;
            fs::create_directory(vat, code);
            const Status images =
                each_layer(archive, static_cast<int>(m), progress, [&](std::size_t k, const std::string& png) {
                    return write_file(vat / fmt::format("vat{}_layer_{:04}.png", letter, k), png);
                });
            if (!images) return images;
        }
        return write_file(inside / "vats.txt", list);
    });
}

/// These formats have only one thickness for all layers.
Status check_alike(const Manifest& m, Format format) {
    if (format != Format::sl1 && format != Format::nanodlp) return {};
    for (std::size_t k = 1; k < m.layers.size(); ++k) {
        if (m.layers[k].thickness_um != m.layers[0].thickness_um)
            return input_error("layer {} is {} um thick, layer 1 {} um: this format knows layers of one thickness only",
                               k + 1, m.layers[k].thickness_um, m.layers[0].thickness_um);
    }
    return {};
}

}  // namespace

Result<Format> format_from(const std::string& name) {
    if (name == "sl1") return Format::sl1;
    if (name == "nanodlp") return Format::nanodlp;
    if (name == "zip") return Format::zip;
    if (name == "vats") return Format::vats;
    return input_error("format \"{}\": must be sl1, nanodlp, zip or vats", name);
}

std::vector<std::string> exposure_notes(const Manifest& manifest, Format format) {
    std::vector<std::string> notes;
    if (format != Format::sl1 && format != Format::nanodlp) return notes;
    const bool sl1 = format == Format::sl1;
    for (std::size_t m = 0; m < manifest.materials.size(); ++m) {
        const StackFacts facts = facts_of(manifest, static_cast<int>(m), "");
        const int other = layers_of_other_light(facts, sl1 ? sl1_lights_s(facts) : nanodlp_lights_s(facts));
        if (other == 0) continue;
        notes.push_back(fmt::format("material \"{}\": {} of it should get other light than {} file can say",
                                    manifest.materials[m].name, counted(static_cast<std::size_t>(other), "layer"),
                                    sl1 ? "an .sl1" : "a .nanodlp"));
    }
    return notes;
}

std::string height_note(const Manifest& manifest, Format format) {
    if (is_even(manifest) || (format != Format::zip && format != Format::vats)) return "";
    const auto [low, high] =
        std::minmax_element(manifest.layers.begin(), manifest.layers.end(),
                            [](const Layer& a, const Layer& b) { return a.thickness_um < b.thickness_um; });
    return fmt::format("the layers are {} to {} um thick, which {} does not say; manifest.json of the job does",
                       low->thickness_um, high->thickness_um, format == Format::zip ? "a .zip" : "a folder of vats");
}

Result<std::vector<fs::path>> export_job(const Archive& archive, Format format, const fs::path& folder,
                                         Progress& progress) {
    if (auto status = check_alike(archive.manifest(), format); !status) return tl::unexpected(status.error());
    if (format == Format::vats) {
        if (auto status = write_vats(archive, folder, progress); !status) return tl::unexpected(status.error());
        return std::vector<fs::path>{folder};
    }
    std::error_code code;
    const bool is_new = fs::create_directories(folder, code);
    if (!fs::is_directory(folder)) return failure("{}: cannot be made a folder", folder.string());
    const char* extension = format == Format::sl1 ? "sl1" : format == Format::nanodlp ? "nanodlp" : "zip";
    std::vector<fs::path> written;
    const Manifest& manifest = archive.manifest();
    for (std::size_t m = 0; m < manifest.materials.size(); ++m) {
        const std::string stem = file_word(manifest.name) + "_" + file_word(manifest.materials[m].name);
        fs::path path = folder / fmt::format("{}.{}", stem, extension);
        if (std::find(written.begin(), written.end(), path) != written.end())
            path = folder / fmt::format("{}_{}.{}", stem, m, extension);
        if (auto status = write_stack(archive, static_cast<int>(m), format, path, progress); !status) {
            if (is_new && written.empty()) fs::remove(folder, code);
            return tl::unexpected(status.error());
        }
        written.push_back(path);
    }
    return written;
}

}  // namespace pliant::job
