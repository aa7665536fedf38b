#include "tamper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "base/zip/zip_file.hpp"
#include "printing/job/manifest.hpp"
#include "printing/job/png.hpp"
#include "printing/job/sha256.hpp"
#include "printing/machine/gcode.hpp"

namespace pliant::app::tamper {
namespace {

using machine::Axis;
using Lines = std::vector<std::string>;
using Found = std::optional<std::size_t>;

template <class T>
T need(Result<T> result) {
    if (!result) throw std::runtime_error(result.error().message);
    return std::move(*result);
}

Found find_line(const Lines& lines, std::string_view begin, std::size_t from = 0) {
    for (std::size_t i = from; i < lines.size(); ++i) {
        if (lines[i].starts_with(begin)) return i;
    }
    return std::nullopt;
}

std::vector<std::size_t> find_all(const Lines& lines, std::string_view begin) {
    std::vector<std::size_t> all;
    for (Found at = find_line(lines, begin); at; at = find_line(lines, begin, *at + 1)) all.push_back(*at);
    return all;
}

Found middle_light(const Parts& p) {
    const auto lights = find_all(p.gcode, ";@expose");
    return lights.empty() ? Found() : Found(lights[lights.size() / 2]);
}

machine::Expose light_of(const std::string& line) {
    return *need(machine::parse_directive(line)).expose;
}

bool drop_line(Lines& lines, Found at) {
    if (!at) return false;
    lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(*at));
    return true;
}

bool replace(std::string& text, const std::string& what, const std::string& with) {
    const std::size_t at = text.find(what);
    if (what.empty() || at == std::string::npos) return false;
    text.replace(at, what.size(), with);
    return true;
}

bool replace_all(Lines& lines, const std::string& what, const std::string& with) {
    bool any = false;
    for (std::string& line : lines) any = replace(line, what, with) || any;
    return any;
}

Tampering other_light(const char* name, std::function<void(machine::Expose&)> change) {
    return {name, Kind::meaning, [change = std::move(change)](Parts& p) {
                const Found at = middle_light(p);
                if (!at) return false;
                machine::Expose e = light_of(p.gcode[*at]);
                change(e);
                p.gcode[*at] = machine::write_expose(e);
                return true;
            }};
}

/// Drops all lines selected by `drops`.
Tampering dropped(const char* name, std::function<bool(const Parts&, std::size_t)> drops) {
    return {name, Kind::meaning, [drops = std::move(drops)](Parts& p) {
                Lines kept;
                for (std::size_t i = 0; i < p.gcode.size(); ++i) {
                    if (!drops(p, i)) kept.push_back(p.gcode[i]);
                }
                const bool any = kept.size() < p.gcode.size();
                p.gcode = std::move(kept);
                return any;
            }};
}

std::vector<Tampering> of_lights() {
    std::vector<Tampering> list = {
        {"a light dropped", Kind::meaning, [](Parts& p) { return drop_line(p.gcode, middle_light(p)); }},
        {"the first light dropped", Kind::meaning,
         [](Parts& p) { return drop_line(p.gcode, find_line(p.gcode, ";@expose")); }},
        {"the last light dropped", Kind::meaning,
         [](Parts& p) {
             const auto lights = find_all(p.gcode, ";@expose");
             return !lights.empty() && drop_line(p.gcode, lights.back());
         }},
        {"a light doubled", Kind::meaning,
         [](Parts& p) {
             const Found at = middle_light(p);
             if (at) p.gcode.insert(p.gcode.begin() + static_cast<std::ptrdiff_t>(*at), std::string(p.gcode[*at]));
             return at.has_value();
         }},
        {"two lights exchanged", Kind::meaning,
         [](Parts& p) {
             const auto lights = find_all(p.gcode, ";@expose");
             if (lights.size() < 2) return false;
             std::swap(p.gcode[lights.front()], p.gcode[lights.back()]);
             return true;
         }},
        dropped("all lights of one layer dropped",
                [](const Parts& p, std::size_t i) {
                    const std::string layer = " layer=1 ";
                    return p.gcode[i].starts_with(";@expose") && p.gcode[i].find(layer) != std::string::npos;
                }),
        dropped("all lights dropped", [](const Parts& p, std::size_t i) { return p.gcode[i].starts_with(";@expose"); }),
        other_light("a light of half the time", [](machine::Expose& e) { e.seconds /= 2; }),
        other_light("a light of twice the time", [](machine::Expose& e) { e.seconds *= 2; }),
        other_light("a light of ten times the time", [](machine::Expose& e) { e.seconds *= 10; }),
        other_light("a light 5 ms too short", [](machine::Expose& e) { e.seconds -= 0.005; }),
        other_light("a light of another layer's number", [](machine::Expose& e) { e.layer += 1; }),
        other_light("a light of a layer that is not there", [](machine::Expose& e) { e.layer += 100000; }),
        other_light("a light of a material that is not there", [](machine::Expose& e) { e.material += 7; }),
        other_light("a light of another image", [](machine::Expose& e) { e.image = "layers/00000_x.png"; }),
    };
    list.push_back({"every light a tenth shorter", Kind::meaning, [](Parts& p) {
                        for (const std::size_t at : find_all(p.gcode, ";@expose")) {
                            machine::Expose e = light_of(p.gcode[at]);
                            e.seconds *= 0.9;
                            p.gcode[at] = machine::write_expose(e);
                        }
                        return true;
                    }});
    list.push_back({"materials exchanged in the lights", Kind::meaning, [](Parts& p) {
                        if (p.manifest.materials.size() < 2) return false;
                        for (const std::size_t at : find_all(p.gcode, ";@expose")) {
                            machine::Expose e = light_of(p.gcode[at]);
                            if (e.material < 2) e.material = 1 - e.material;
                            p.gcode[at] = machine::write_expose(e);
                        }
                        return true;
                    }});
    return list;
}

/// The last downward move before the exposure at line `at`.
Found descent_before(const Parts& p, std::size_t at) {
    const std::string begin = fmt::format("G1 {}", p.printer.axis(Axis::platform).letter);
    for (std::size_t i = at; i-- > 0;) {
        if (p.gcode[i].starts_with(begin)) return i;
    }
    return std::nullopt;
}

/// Changes the height of the platform for an exposure in the middle.
Tampering height(const char* name, double more_mm) {
    return {name, Kind::meaning, [more_mm](Parts& p) {
                const Found at = middle_light(p);
                const Found down = at ? descent_before(p, *at) : Found();
                if (!down) return false;
                const machine::Command c = need(machine::parse_command(p.gcode[*down]));
                const char letter = p.printer.axis(Axis::platform).letter;
                p.gcode[*down] =
                    fmt::format("G1 {}{:.3f} F{:.1f}", letter, *c.value(letter) + more_mm, c.value('F').value_or(60));
                return true;
            }};
}

/// Changes the feed rate of the move returned by `find`.
Tampering faster(const char* name, std::function<Found(const Parts&)> find) {
    return {name, Kind::meaning, [find = std::move(find)](Parts& p) {
                const Found at = find(p);
                if (!at) return false;
                std::string& line = p.gcode[*at];
                line = line.substr(0, line.find(" F")) + " F60000.0";
                return true;
            }};
}

/// The upward move after an exposure, by the platform's lift alone.
Found lift_after(const Parts& p, std::size_t light) {
    const std::string begin = fmt::format("G1 {}", p.printer.axis(Axis::platform).letter);
    return find_line(p.gcode, begin, light);
}

std::vector<Tampering> of_moves() {
    const auto shear = [](const Parts& p) { return fmt::format("G1 {}", p.printer.axis(Axis::carriage).letter); };
    return {
        height("a layer 30 um low", -0.03),
        height("a layer 30 um high", 0.03),
        height("a layer 1 um low", -0.001),
        {"the way down to a layer dropped", Kind::meaning,
         [](Parts& p) {
             const Found at = middle_light(p);
             return at && drop_line(p.gcode, descent_before(p, *at));
         }},
        {"the lift after a layer dropped", Kind::meaning,
         [](Parts& p) {
             const Found at = find_line(p.gcode, ";@expose");
             return at && drop_line(p.gcode, lift_after(p, *at));
         }},
        {"the shear stroke dropped", Kind::meaning,
         [shear](Parts& p) {
             const Found light = middle_light(p);
             if (!light || p.printer.carriage.shear_um == 0) return false;
             return drop_line(p.gcode, find_line(p.gcode, shear(p), *light));
         }},
        {"the rest before a light dropped", Kind::meaning,
         [](Parts& p) {
             const Found light = middle_light(p);
             const Found down = light ? descent_before(p, *light) : Found();
             return down && p.gcode[*down + 1].starts_with("G4") && drop_line(p.gcode, *down + 1);
         }},
        {"the rest after a light dropped", Kind::meaning,
         [](Parts& p) {
             const Found light = middle_light(p);
             return light && p.gcode[*light + 1].starts_with("G4") && drop_line(p.gcode, *light + 1);
         }},
        faster("down into the resin at full speed",
               [](const Parts& p) {
                   const Found at = middle_light(p);
                   return at ? descent_before(p, *at) : Found();
               }),
        faster("the layer peeled at full speed",
               [](const Parts& p) {
                   const Found at = find_line(p.gcode, ";@expose");
                   return at ? lift_after(p, *at) : Found();
               }),
        {"the motors let go in the middle", Kind::meaning,
         [](Parts& p) {
             p.gcode.insert(p.gcode.begin() + static_cast<std::ptrdiff_t>(p.gcode.size() / 2), "M84");
             return true;
         }},
        {"motors that may let go", Kind::meaning,
         [](Parts& p) { return drop_line(p.gcode, find_line(p.gcode, "M84")); }},
        {"relative coordinates", Kind::meaning,
         [](Parts& p) {
             const Found at = find_line(p.gcode, "G90");
             if (at) p.gcode[*at] = "G91";
             return at.has_value();
         }},
        {"an origin moved", Kind::meaning,
         [](Parts& p) {
             const Found at = middle_light(p);
             if (!at) return false;
             p.gcode.insert(p.gcode.begin() + static_cast<std::ptrdiff_t>(*at), "G92 Z1.000");
             return true;
         }},
        {"an axis that is not homed", Kind::meaning,
         [](Parts& p) { return drop_line(p.gcode, find_line(p.gcode, "G28")); }},
    };
}

/// The lines of the first cleaning between two vats: after the pump's start, up to its end.
std::pair<std::size_t, std::size_t> cleaning_of(const Parts& p) {
    if (p.printer.pump.on.empty()) return {0, 0};
    const Found on = find_line(p.gcode, p.printer.pump.on);
    const Found off = on ? find_line(p.gcode, p.printer.pump.off, *on) : Found();
    return off ? std::pair(*on + 1, *off) : std::pair<std::size_t, std::size_t>(0, 0);
}

/// True if a line of the cleaning is a stroke: it moves the platform.
bool is_stroke(const Parts& p, const std::string& line) {
    return line.starts_with("G1") &&
           line.find(fmt::format(" {}", p.printer.axis(Axis::platform).letter)) != std::string::npos;
}

std::vector<Tampering> of_cleaning() {
    const auto strokes = [](const char* name, std::function<std::string(const std::string&)> change) -> Tampering {
        return {name, Kind::meaning, [change = std::move(change)](Parts& p) {
                    const auto [begin, end] = cleaning_of(p);
                    bool any = false;
                    for (std::size_t i = begin; i < end; ++i) {
                        if (!is_stroke(p, p.gcode[i]) || p.printer.cleaning.stroke_z_um == 0) continue;
                        p.gcode[i] = change(p.gcode[i]);
                        any = true;
                    }
                    return any;
                }};
    };
    const auto without = [](const char* name, std::string machine::Switch::*text) -> Tampering {
        return dropped(name, [text](const Parts& p, std::size_t i) { return p.gcode[i] == p.printer.pump.*text; });
    };
    return {
        {"cleaning left out", Kind::meaning,
         [](Parts& p) {
             const auto [begin, end] = cleaning_of(p);
             const auto is_wait = [&](const std::string& l) { return l.starts_with("G4") || is_stroke(p, l); };
             const auto first = p.gcode.begin() + static_cast<std::ptrdiff_t>(begin),
                        last = p.gcode.begin() + static_cast<std::ptrdiff_t>(end);
             const auto kept = std::remove_if(first, last, is_wait);
             const bool any = kept != last;
             p.gcode.erase(kept, last);
             return any;
         }},
        strokes("a rest in place of the strokes", [](const std::string&) { return std::string("G4 P1000"); }),
        strokes("strokes at a crawl", [](const std::string& l) { return l.substr(0, l.find(" F")) + " F20.0"; }),
        without("the pump never on", &machine::Switch::on),
        without("the pump never off", &machine::Switch::off),
        {"the pump off as soon as it is on", Kind::meaning,
         [](Parts& p) {
             const auto [begin, end] = cleaning_of(p);
             if (end == 0) return false;
             p.gcode.insert(p.gcode.begin() + static_cast<std::ptrdiff_t>(begin), std::string(p.printer.pump.off));
             return true;
         }},
        {"the pump a tenth as strong", Kind::meaning,
         [](Parts& p) {
             std::string weak = p.printer.pump.on;
             return replace(weak, "S255", "S25") && replace_all(p.gcode, p.printer.pump.on, weak);
         }},
        {"no way to stop the pump", Kind::meaning,
         [](Parts& p) { return drop_line(p.gcode, find_line(p.gcode, ";@stop " + p.printer.pump.off)); }},
        {"a stop that lets the motors go", Kind::meaning,
         [](Parts& p) {
             const Found at = find_line(p.gcode, ";@stop");
             if (at) p.gcode[*at] = ";@stop M84";
             return at.has_value();
         }},
        dropped("drying left out",
                [](const Parts& p, std::size_t i) {
                    return !p.printer.fans.empty() && p.gcode[i] == p.printer.fans[0].on;
                }),
        {"a fan that is not switched off", Kind::meaning,
         [](Parts& p) {
             const Found on = p.printer.fans.empty() ? Found() : find_line(p.gcode, p.printer.fans[0].on);
             return on && drop_line(p.gcode, find_line(p.gcode, p.printer.fans[0].off, *on));
         }},
        {"a whole change of vats left out", Kind::meaning,
         [](Parts& p) {
             const Found begin = find_line(p.gcode, "; swap"), end = find_line(p.gcode, "; layer", begin.value_or(0));
             if (!begin || !end) return false;
             p.gcode.erase(p.gcode.begin() + static_cast<std::ptrdiff_t>(*begin),
                           p.gcode.begin() + static_cast<std::ptrdiff_t>(*end));
             return true;
         }},
    };
}

/// Exchanges the resins of two vats in printer.toml.
bool exchange_vats(Parts& p) {
    if (p.printer.vats.size() < 2) return false;
    const std::string a = fmt::format("resin = \"{}\"", p.printer.vats[0].resin),
                      b = fmt::format("resin = \"{}\"", p.printer.vats[1].resin);
    std::string& text = p.entries["printer.toml"];
    return replace(text, a, "@") && replace(text, b, a) && replace(text, "@", b);
}

/// Replaces the value of `key = ` in printer.toml.
Tampering printer_key(const char* name, std::string key, std::string value) {
    return {name, Kind::meaning, [key = std::move(key), value = std::move(value)](Parts& p) {
                std::string& text = p.entries["printer.toml"];
                const std::size_t at = text.find("\n" + key + " = ");
                if (at == std::string::npos) return false;
                text.replace(at, text.find('\n', at + 1) - at, "\n" + key + " = " + value);
                return true;
            }};
}

std::vector<Tampering> of_vats() {
    return {
        {"another vat of the tower", Kind::meaning,
         [](Parts& p) {
             if (p.printer.store() != machine::Store::tower || p.printer.vats.size() < 3) return false;
             const auto at = [&](int slot, int less_um) {
                 return fmt::format(" {}{:.3f}", p.printer.axis(Axis::tower).letter,
                                    (p.printer.level_um(slot) - less_um) / 1000.0);
             };
             const int from = p.printer.vats[0].slot, to = p.printer.vats[2].slot, low_um = p.printer.hooks.travel_um;
             const bool level = replace_all(p.gcode, at(from, 0), at(to, 0));
             return replace_all(p.gcode, at(from, low_um), at(to, low_um)) && level;
         }},
        {"two vats exchanged in the printer file", Kind::meaning, exchange_vats},
        {"a vat with another resin in the printer file", Kind::meaning,
         [](Parts& p) {
             return replace(p.entries["printer.toml"], fmt::format("resin = \"{}\"", p.printer.vats[0].resin),
                            "resin = \"honey\"");
         }},
        printer_key("a longer spray in the printer file", "spray", "\"90 s\""),
        printer_key("a longer bath in the printer file", "duration", "\"500 s\""),
        printer_key("a higher lift in the printer file", "lift", "\"9 mm\""),
        printer_key("a longer rest in the printer file", "settle", "\"3 s\""),
        printer_key("a smaller build height in the printer file", "build_height", "\"0.1 mm\""),
        {"a resin misspelt in the manifest", Kind::meaning,
         [](Parts& p) {
             p.manifest.materials[0].resin += "x";
             return true;
         }},
        {"resins exchanged in the manifest", Kind::meaning,
         [](Parts& p) {
             if (p.manifest.materials.size() < 2 || p.manifest.materials[0].resin == p.manifest.materials[1].resin)
                 return false;
             std::swap(p.manifest.materials[0].resin, p.manifest.materials[1].resin);
             return true;
         }},
    };
}

Tampering cut(const char* name, double share) {
    return {name, Kind::meaning, [share](Parts& p) {
                p.gcode.resize(static_cast<std::size_t>(share * static_cast<double>(p.gcode.size())));
                return true;
            }};
}

std::vector<Tampering> of_the_whole() {
    return {
        cut("a program cut to nothing", 0),
        cut("a program cut in half", 0.5),
        cut("a program cut after nine tenths", 0.9),
        {"a program that ends with the last light", Kind::meaning,
         [](Parts& p) {
             const auto lights = find_all(p.gcode, ";@expose");
             if (lights.empty()) return false;
             p.gcode.resize(lights.back() + 1);
             return true;
         }},
        {"the vat not put away at the end", Kind::meaning,
         [](Parts& p) {
             const Found at = find_line(p.gcode, "; store");
             if (!at || p.printer.store() == machine::Store::none) return false;
             const Found end = find_line(p.gcode, "; the end");
             p.gcode.erase(p.gcode.begin() + static_cast<std::ptrdiff_t>(*at),
                           p.gcode.begin() + static_cast<std::ptrdiff_t>(*end));
             return true;
         }},
        {"a fan that runs on", Kind::meaning,
         [](Parts& p) {
             if (p.printer.fans.empty()) return false;
             p.gcode.push_back(p.printer.fans[0].on);
             return true;
         }},
        {"a command of another machine", Kind::meaning,
         [](Parts& p) {
             p.gcode.insert(p.gcode.begin() + static_cast<std::ptrdiff_t>(p.gcode.size() / 2), "M104 S200");
             return true;
         }},
        {"no printer file", Kind::meaning, [](Parts& p) { return p.entries.erase("printer.toml") > 0; }},
        {"no image", Kind::meaning,
         [](Parts& p) { return p.entries.erase(p.manifest.layers[0].images.at(0).file) > 0; }},
        {"another time in the manifest", Kind::meaning,
         [](Parts& p) {
             p.manifest.layers.back().images.at(0).exposure_s = 9.99;
             return true;
         }},
        {"more bottom layers in the manifest", Kind::meaning,
         [](Parts& p) {
             p.manifest.bottom_layers += 2;
             return true;
         }},
        {"a layer higher in the manifest", Kind::meaning,
         [](Parts& p) {
             p.manifest.layers.back().z_um += 10;
             return true;
         }},
        {"a layer more in the manifest", Kind::meaning,
         [](Parts& p) {
             job::Layer layer = p.manifest.layers.back();
             layer.z_um += layer.thickness_um;
             p.manifest.layers.push_back(layer);
             return true;
         }},
        {"a layer less in the manifest", Kind::meaning,
         [](Parts& p) {
             p.manifest.layers.pop_back();
             return true;
         }},
        {"another pixel in the manifest", Kind::meaning,
         [](Parts& p) {
             p.manifest.pixel_um *= 1.01;
             return true;
         }},
        {"an image's name of another layer in the manifest", Kind::meaning,
         [](Parts& p) {
             std::vector<job::LayerImage*> images;
             for (job::Layer& layer : p.manifest.layers) {
                 for (job::LayerImage& image : layer.images) images.push_back(&image);
             }
             if (images.size() < 2) return false;
             std::swap(images.front()->file, images.back()->file);
             return true;
         }},
    };
}

job::LayerImage& middle_image(Parts& p) {
    std::vector<job::LayerImage*> images;
    for (job::Layer& layer : p.manifest.layers) {
        for (job::LayerImage& image : layer.images) images.push_back(&image);
    }
    return *images.at(images.size() / 2);
}

/// Changes pixels of an image; `adjusted`: the manifest has the new area.
Tampering pixels(const char* name, bool adjusted, std::function<void(job::Image&)> change) {
    return {name, adjusted ? Kind::pixels : Kind::areas, [adjusted, change = std::move(change)](Parts& p) {
                job::LayerImage& entry = middle_image(p);
                job::Image image = need(
                    job::decode_png(p.entries.at(entry.file), {p.manifest.width_px, p.manifest.height_px}, "image"));
                const std::vector<std::uint8_t> before = image.pixels;
                change(image);
                double sum = 0;
                for (const std::uint8_t value : image.pixels) sum += value;
                if (adjusted) entry.area_mm2 = sum / 255 * p.manifest.pixel_um * p.manifest.pixel_um / 1e6;
                if (adjusted) entry.shared_mm2 = std::min(entry.shared_mm2, entry.area_mm2);
                p.entries[entry.file] = job::encode_png(image);
                return image.pixels != before;
            }};
}

/// Turns some fully lit pixels dark.
void darken(job::Image& image, int count) {
    for (std::uint8_t& value : image.pixels) {
        if (value == 255 && count-- > 0) value = 0;
    }
}

/// Lights dark pixels in the last rows.
void stray(job::Image& image) {
    for (std::size_t i = image.pixels.size() - 5; i < image.pixels.size(); ++i) image.pixels[i] = 255;
}

std::vector<Tampering> of_pixels() {
    const auto flat = [](job::Image& image) {
        for (std::uint8_t& value : image.pixels) value = static_cast<std::uint8_t>(value / 2);
    };
    const auto shifted = [](job::Image& image) {
        std::rotate(image.pixels.begin(), image.pixels.begin() + 1, image.pixels.end());
    };
    return {
        pixels("20 dark pixels", false, [](job::Image& i) { darken(i, 20); }),
        pixels("20 dark pixels, the area adjusted", true, [](job::Image& i) { darken(i, 20); }),
        pixels("one dark pixel, the area adjusted", true, [](job::Image& i) { darken(i, 1); }),
        pixels("stray pixels", false, stray),
        pixels("stray pixels, the area adjusted", true, stray),
        pixels("an image half as bright", false, flat),
        pixels("an image half as bright, the area adjusted", true, flat),
        pixels("an image moved by a pixel", true, shifted),
        {"images of two layers exchanged, the areas too", Kind::pixels,
         [](Parts& p) {
             job::LayerImage *first = nullptr, *last = nullptr;
             for (job::Layer& layer : p.manifest.layers) {
                 for (job::LayerImage& image : layer.images) {
                     if (image.material != 0) continue;
                     if (first == nullptr) first = &image;
                     last = &image;
                 }
             }
             if (first == nullptr || p.entries[first->file] == p.entries[last->file]) return false;
             std::swap(p.entries[first->file], p.entries[last->file]);
             std::swap(first->area_mm2, last->area_mm2);
             return true;
         }},
    };
}

}  // namespace

std::vector<Tampering> tamperings() {
    std::vector<Tampering> all;
    for (auto list : {of_lights(), of_moves(), of_cleaning(), of_vats(), of_the_whole(), of_pixels()})
        all.insert(all.end(), list.begin(), list.end());
    return all;
}

Parts take_apart(const std::filesystem::path& file) {
    const ZipReader zip = need(ZipReader::open(file));
    constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;
    Parts parts;
    for (std::uint64_t i = 0; i < zip.entry_count(); ++i)
        parts.entries[zip.name(i)] = need(zip.read(zip.name(i), most_bytes));
    parts.manifest = need(job::manifest_from_json(parts.entries.at("manifest.json"), "manifest.json"));
    parts.printer = need(machine::parse_printer(parts.entries.at("printer.toml"), "printer.toml"));
    const std::string text = parts.entries.at("job.gcode");
    for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
        parts.gcode.push_back(text.substr(at, text.find('\n', at) - at));
    parts.entries.erase("manifest.json");
    parts.entries.erase("job.gcode");
    return parts;
}

void put_together(const Parts& parts, bool remade, const std::filesystem::path& file) {
    std::map<std::string, std::string> entries = parts.entries;
    std::string& gcode = entries["job.gcode"];
    for (const std::string& line : parts.gcode) gcode += line + "\n";
    job::Manifest manifest = parts.manifest;
    if (remade) {
        manifest.sha256.clear();
        for (const auto& [name, bytes] : entries) manifest.sha256[name] = job::sha256_hex(bytes);
    }
    entries["manifest.json"] = job::to_json(manifest);
    ZipWriter zip = need(ZipWriter::create(file));
    for (const auto& [name, bytes] : entries) {
        if (const Status added = zip.add(name, bytes, ZipWriter::Method::deflate); !added)
            throw std::runtime_error(added.error().message);
    }
    if (const Status closed = zip.close(); !closed) throw std::runtime_error(closed.error().message);
}

}  // namespace pliant::app::tamper
