#include "presentation/print_report/print_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/core/base64.hpp"
#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "presentation/print_report/job_picture.hpp"
#include "presentation/print_report/layer_plot.hpp"
#include "presentation/print_report/material_colours.hpp"
#include "presentation/print_report/plan_picture.hpp"
#include "presentation/print_report/print_story.hpp"
#include "presentation/report/assets.hpp"
#include "presentation/report/html.hpp"
#include "printing/host/control_types.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/host/resume_point.hpp"
#include "printing/host/script.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/timeline.hpp"

namespace pliant::report {
namespace {

constexpr std::uintmax_t largest_journal = 256 << 20;
constexpr std::size_t most_records = 4000;

constexpr std::string_view style = R"(
.plot svg { width: 100%; height: 100%; display: block; }
.plot polyline { fill: none; stroke-width: 2; vector-effect: non-scaling-stroke; }
.plot line { stroke: var(--line); }
.plots .card { break-inside: avoid; }
.pictures { grid-template-columns: 1fr 1fr; }
figure img { cursor: default; }
.fault td:first-child { border-left: 4px solid var(--bad); }
.pill + .message, p + figure, .scroll + .scroll { margin-top: 14px; }
.scroll + h3 { margin-top: 18px; }
td.wide { white-space: normal; text-align: left; min-width: 18em; }
)";

/// Counted from the first exposure of all.
struct PlannedTimes {
    std::vector<double> at_s;  ///< of every layer's first exposure; -1: none
    double end_s = 0;          ///< of the last exposure
};

struct Printed {
    const job::Archive& archive;
    const machine::Printer& printer;
    const PrintExtras& extras;
    PrintStory story;
    plan::Plan plan;
    PlannedTimes planned;
};

std::string swatch(const Colour& colour) {
    return fmt::format("<span class=\"swatch\" style=\"background:{}\"></span>", hex(colour));
}

std::string figure(const std::string& png, std::string_view title) {
    return fmt::format(
        "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n", title,
        base64(png));
}

std::string_view end_text(PrintEnd end) {
    switch (end) {
        case PrintEnd::complete:
            return "complete";
        case PrintEnd::cancelled:
            return "cancelled";
        case PrintEnd::interrupted:
            return "interrupted";
        case PrintEnd::not_begun:
            break;
    }
    return "not begun";
}

PlannedTimes planned_times(const plan::Plan& plan, const job::Manifest& job, const machine::Printer& printer) {
    const plan::JobTimeline line = plan::job_timeline(plan, job, printer);
    PlannedTimes planned{std::vector<double>(job.layers.size(), -1), 0};
    std::size_t visit = 0;
    double first_s = -1;
    for (const plan::Stretch& s : line.stretches) {
        if (s.device != plan::Device::light) continue;
        while (visit + 1 < line.visits.size() && line.visits[visit].end_s < s.end_s) ++visit;
        if (visit >= line.visits.size()) break;
        if (first_s < 0) first_s = s.begin_s;
        double& mine = planned.at_s[static_cast<std::size_t>(line.visits[visit].layer)];
        if (mine < 0) mine = s.begin_s - first_s;
        planned.end_s = std::max(planned.end_s, s.end_s - first_s);
    }
    return planned;
}

/// Time of the first exposure of each layer; -1: none.
std::vector<double> given_times(const PrintStory& story, std::size_t layers) {
    std::vector<double> at(layers, -1);
    for (const auto& [key, light] : story.lights) {
        if (key.first < 0 || static_cast<std::size_t>(key.first) >= layers) continue;
        double& mine = at[static_cast<std::size_t>(key.first)];
        if (mine < 0 || light.at_s < mine) mine = light.at_s;
    }
    return at;
}

// --- resin ---------------------------------------------------------------------------------------------------------

/// ml of every material, in the exposed layers and in all layers.
struct Resin {
    double printed_ml = 0, all_ml = 0;
};

std::vector<Resin> resin_of(const Printed& p) {
    const job::Manifest& m = p.archive.manifest();
    std::vector<Resin> resin(m.materials.size());
    for (std::size_t l = 0; l < m.layers.size(); ++l) {
        for (const job::LayerImage& image : m.layers[l].images) {
            const double ml = image.area_mm2 * m.layers[l].thickness_um * 1e-6;
            Resin& mine = resin[static_cast<std::size_t>(image.material)];
            mine.all_ml += ml;
            const auto light = p.story.lights.find({static_cast<int>(l), image.material});
            if (light != p.story.lights.end() && light->second.complete) mine.printed_ml += ml;
        }
    }
    return resin;
}

// --- sections ------------------------------------------------------------------------------------------------------

std::string heading(const Printed& p) {
    const bool good = p.story.end == PrintEnd::complete;
    const job::Manifest& m = p.archive.manifest();
    return fmt::format(
        "<div class=\"head\"><h1>{}</h1><span class=\"pill {}\">{}</span></div>\n<p class=\"faint\">printed on {}{}{}; "
        "{}, {} x {} px of {:.6g} um</p>\n",
        html_escaped(m.name), good ? "good" : "bad", end_text(p.story.end), html_escaped(p.printer.name),
        p.extras.machine.empty() ? "" : html_escaped(", " + p.extras.machine),
        p.extras.firmware.empty() ? "" : html_escaped(", " + p.extras.firmware), counted(m.layers.size(), "layer"),
        m.width_px, m.height_px, m.pixel_um);
}

std::string tiles(const Printed& p) {
    double lit_s = 0, last_s = 0, resin_ml = 0;
    std::size_t whole = 0, images = 0;
    for (const auto& [key, light] : p.story.lights) {
        lit_s += light.lit_s;
        last_s = std::max(last_s, light.at_s + light.lit_s);
        whole += light.complete ? 1 : 0;
    }
    for (const job::Layer& layer : p.archive.manifest().layers) images += layer.images.size();
    for (const Resin& resin : resin_of(p)) resin_ml += resin.printed_ml;
    std::string out = "<section class=\"tiles\">\n";
    out += html_tile(fmt::format("{} of {}", whole, images), "images fully exposed");
    out += html_tile(plan::clock_text(last_s),
                     fmt::format("first to last exposure; planned {}", plan::clock_text(p.planned.end_s)));
    out += html_tile(plan::clock_text(lit_s), "exposure time");
    out += html_tile(fmt::format("{:.2f} ml", resin_ml), "resin cured, as drawn");
    out += html_tile(fmt::format("{}", p.plan.swaps), p.plan.swaps == 1 ? "swap planned" : "swaps planned");
    out += html_tile(fmt::format("{}", p.story.faults), p.story.faults == 1 ? "fault" : "faults");
    if (p.extras.lines_sent >= 0)
        out += html_tile(fmt::format("{}", p.extras.lines_sent),
                         fmt::format("lines sent by the last host, {} resent", std::max(p.extras.resends, 0L)));
    return out + "</section>\n";
}

std::string happenings(const Printed& p) {
    if (p.story.happenings.empty())
        return "<h2>What happened</h2>\n<p>One host, no pause, no fault: every step as planned.</p>\n";
    std::string out =
        "<h2>What happened</h2>\n<p>Layers are counted from 1; in the job and its journal from 0.</p>\n<div "
        "class=\"scroll\"><table "
        "class=\"words\"><thead><tr><th>after</th><th>layer</th>"
        "<th>what</th><th>how it went on</th></tr></thead><tbody>\n";
    for (const Happening& h : p.story.happenings) {
        out +=
            fmt::format("<tr{}><td>{}</td><td>{}</td><td class=\"wide\">{}</td><td class=\"wide\">{}</td></tr>\n",
                        h.fault ? " class=\"fault\"" : "", h.at_s < 0 ? "–" : plan::clock_text(h.at_s),
                        h.layer < 0 ? "–" : fmt::format("{}", h.layer + 1), html_escaped(h.text), html_escaped(h.then));
    }
    return out + "</tbody></table></div>\n";
}

std::string materials(const Printed& p) {
    const job::Manifest& m = p.archive.manifest();
    const std::vector<Colour> colours = material_colours(m);
    const std::vector<Resin> resin = resin_of(p);
    std::string out =
        "<h2>Materials and resin</h2>\n<div class=\"scroll\"><table><thead><tr><th>material</th><th>resin</th>"
        "<th>slot</th><th>exposure</th><th>bottom layers</th><th>cured</th><th>planned</th></tr></thead><tbody>\n";
    for (std::size_t k = 0; k < m.materials.size(); ++k) {
        const job::Material& material = m.materials[k];
        const int vat = p.plan.vat_of_material[k];
        out += fmt::format(
            "<tr><td>{}{}</td><td>{}</td><td>{}</td><td>{:g} s</td><td>{:g} "
            "s</td><td>{:.3f} ml</td><td>{:.3f} ml</td></tr>\n",
            swatch(colours[k]), html_escaped(material.name), html_escaped(material.resin),
            vat < 0 ? "–" : fmt::format("{}", p.printer.slot_of(vat)), material.exposure_s, material.bottom_exposure_s,
            resin[k].printed_ml, resin[k].all_ml);
    }
    return out + fmt::format(
                     "</tbody></table></div>\n<p class=\"faint\">As drawn. The plan counts {:.2f} ml more that "
                     "cling to the part and are wasted, and {:.0f} ml of cleaning solution used up.</p>\n",
                     p.plan.waste_ml, p.plan.solvent_ml);
}

// --- plots ---------------------------------------------------------------------------------------------------------

std::string plots(const Printed& p) {
    const job::Manifest& m = p.archive.manifest();
    const int layers = static_cast<int>(m.layers.size());
    const std::vector<double> given = given_times(p.story, m.layers.size());
    LayerLine planned{"planned", "var(--faint)", {}, true}, happened{"happened", "var(--accent)", {}, false};
    for (std::size_t l = 0; l < m.layers.size(); ++l) {
        if (p.planned.at_s[l] >= 0) planned.points.emplace_back(l, p.planned.at_s[l] / 60);
        if (given[l] >= 0) happened.points.emplace_back(l, given[l] / 60);
    }
    std::string out = "<h2>Plan and print</h2>\n<section class=\"plots\">\n";
    out += layer_plot("When each layer had its first light", "min", {planned, happened}, layers);
    const std::vector<Colour> colours = material_colours(m);
    std::vector<LayerLine> light;
    for (std::size_t k = 0; k < m.materials.size(); ++k) {
        LayerLine asked{m.materials[k].name + ", planned", "var(--faint)", {}, true};
        LayerLine lit{m.materials[k].name + ", given", hex(colours[k]), {}, false};
        for (std::size_t l = 0; l < m.layers.size(); ++l) {
            const auto found = p.story.lights.find({static_cast<int>(l), static_cast<int>(k)});
            if (found == p.story.lights.end()) continue;
            asked.points.emplace_back(l, found->second.planned_s);
            lit.points.emplace_back(l, found->second.lit_s);
        }
        if (lit.points.empty()) continue;
        light.push_back(std::move(asked));
        light.push_back(std::move(lit));
    }
    if (!light.empty()) out += layer_plot("Light of each layer", "s", light, layers);
    return out + "</section>\n";
}

std::string lights_table(const Printed& p) {
    const job::Manifest& m = p.archive.manifest();
    std::string out =
        "<details><summary>Every light in numbers</summary>\n<div class=\"scroll\"><table><thead><tr><th>layer</th>"
        "<th>material</th><th>after</th><th>planned</th><th>given</th><th>pieces</th><th>whole</th></tr></"
        "thead><tbody>\n";
    for (const auto& [key, light] : p.story.lights) {
        const auto material = static_cast<std::size_t>(key.second);
        out += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.3f} s</td><td>{:.3f} s</td><td>{}</td><td>{}</td></tr>\n",
            key.first + 1, material < m.materials.size() ? html_escaped(m.materials[material].name) : "?",
            plan::clock_text(light.at_s), light.planned_s, light.lit_s, light.pieces, light.complete ? "yes" : "no");
    }
    return out + "</tbody></table></div>\n</details>\n";
}

std::string journal_section(const std::vector<host::JournalRecord>& journal) {
    std::string text;
    const std::size_t first = journal.size() - std::min(journal.size(), most_records);
    if (first > 0) text += fmt::format("... {} records before\n", first);
    for (std::size_t k = first; k < journal.size(); ++k) {
        text += fmt::format("{} {}", journal[k].number, journal[k].kind);
        for (const auto& [key, value] : journal[k].values) {
            const std::string_view line = std::string_view(value).substr(0, value.find('\n'));
            text += fmt::format(" {}={}{}", key, line, line.size() < value.size() ? " ..." : "");
        }
        text += '\n';
    }
    return "<h2>Journal</h2>\n<details><summary>" + fmt::format("{} records", journal.size()) + "</summary>\n<pre>" +
           escaped_lines(text) + "</pre></details>\n";
}

std::string settings_section(const Printed& p) {
    const Result<std::string> text = p.archive.file("settings.json");
    std::string out = "<h2>Settings</h2>\n";
    for (const std::string& warning : p.archive.manifest().warnings)
        out += "<p class=\"message\">" + html_escaped(warning) + "</p>\n";
    for (const std::string& warning : p.plan.warnings)
        out += "<p class=\"message\">" + html_escaped(warning) + "</p>\n";
    if (!text) return out + "<p class=\"faint\">The job keeps none.</p>\n";
    return out + "<details><summary>How the job was made (settings.json)</summary>\n<pre>" + escaped_lines(*text) +
           "</pre></details>\n";
}

Result<std::string> block_of(const Printed& p) {
    if (!p.extras.block) return std::string();
    return block_picture(*p.extras.block, p.archive.manifest(), p.printer.projector).map([&](const std::string& png) {
        return block_section(*p.extras.block, p.archive.manifest(), png);
    });
}

Result<std::string> pictures(const Printed& p) {
    const Result<std::string> part = job_picture(p.archive), layers = layers_picture(p.archive),
                              plan = plan_picture(p.plan, plan::longest_swap(p.plan, p.printer));
    for (const auto* png : {&part, &layers, &plan}) {
        if (!*png) return tl::unexpected(png->error());
    }
    return "<section class=\"pictures\">\n" + figure(*part, "The part") + figure(*layers, "Its layers") +
           figure(*plan, "The plan") + "</section>\n";
}

std::string head(const Printed& p) {
    return fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
        "style-src 'unsafe-inline'\">\n<title>{} · print · Pliant</title>\n<style>\n{}\n{}\n</style>\n</head>\n"
        "<body>\n<main>\n",
        html_escaped(p.archive.manifest().name), assets::report_css, style);
}

/// Errors: a record about something that the job, or its machine, does not have.
Status check_records(const host::JournalFacts& facts, const operate::OpenJob& open) {
    const Result<std::string> gcode = open.archive.file("job.gcode");
    if (!gcode) return tl::unexpected(gcode.error());
    const Result<host::Script> script = host::read_script(*gcode);
    if (!script) return tl::unexpected(script.error());
    const job::Manifest& m = open.archive.manifest();
    host::PrintJob job;
    job.layers = static_cast<int>(m.layers.size());
    for (const job::Material& material : m.materials) job.materials.push_back(material.name);
    if (Status fits = host::check_fits(facts, *script, job); !fits) return fits;
    if (!facts.go) return {};
    const auto known = host::last_known(facts, open.printer);
    return known ? Status() : tl::unexpected(known.error());
}

}  // namespace

Result<std::string> print_report(const job::Archive& archive, const machine::Printer& printer,
                                 const std::vector<host::JournalRecord>& journal, const PrintExtras& extras) {
    const job::Manifest& m = archive.manifest();
    Result<plan::Plan> plan = plan::make_plan(m, printer);
    if (!plan) return tl::unexpected(plan.error());
    std::vector<std::string> names;
    for (const job::Material& material : m.materials) names.push_back(material.name);
    Result<PrintStory> story = story_of(journal, names);
    if (!story) return tl::unexpected(story.error());
    PlannedTimes planned = planned_times(*plan, m, printer);
    const Printed p{archive, printer, extras, std::move(*story), std::move(*plan), std::move(planned)};
    const Result<std::string> drawn = pictures(p);
    if (!drawn) return drawn;
    const Result<std::string> cured = block_of(p);
    if (!cured) return cured;
    return head(p) + heading(p) + tiles(p) + *drawn + *cured + happenings(p) + plots(p) + lights_table(p) +
           materials(p) + settings_section(p) + journal_section(journal) +
           "<footer><p>Made by Pliant " PLIANT_VERSION
           ". Nothing on this page is loaded from a network.</p></footer>\n</main>\n</body>\n</html>\n";
}

Result<std::string> print_report(const std::filesystem::path& job, const std::filesystem::path& journal,
                                 const PrintExtras& extras) {
    const Result<operate::OpenJob> open = operate::open_job(job);
    if (!open) return tl::unexpected(open.error());
    const Result<std::string> bytes = read_file(job);
    if (!bytes) return tl::unexpected(bytes.error());
    const Result<std::string> text = read_file(journal, largest_journal);
    if (!text) return tl::unexpected(text.error());
    const Result<host::JournalText> records = host::parse_journal(*text, journal.string());
    if (!records) return tl::unexpected(records.error());
    const Result<PrintStory> story = story_of(records->records);
    if (!story) return tl::unexpected(story.error());
    // A story can be told of records that mean something else, as those of a newer format.
    const auto facts = host::facts_of(records->records);
    if (!facts) return input_error("{}: {}", journal.string(), facts.error().message);
    if (!story->digest.empty() && story->digest != host::job_digest(*bytes))
        return input_error("{}: this journal is of another job, or {} has changed since", journal.string(),
                           job.filename().string());
    if (Status fits = check_records(*facts, *open); !fits)
        return input_error("{}: {}", journal.string(), fits.error().message);
    return print_report(open->archive, open->printer, records->records, extras);
}

}  // namespace pliant::report
