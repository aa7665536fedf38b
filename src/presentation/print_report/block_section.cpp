// The cured block as text and numbers.
#include <fmt/format.h>

#include <algorithm>

#include "base/core/base64.hpp"
#include "base/core/counted.hpp"
#include "presentation/draw/colour.hpp"
#include "presentation/print_report/cured_block.hpp"
#include "presentation/print_report/material_colours.hpp"
#include "presentation/report/html.hpp"

namespace pliant::report {
namespace {

constexpr std::size_t most_lines = 12;

/// Deviations that were accepted.
std::vector<std::string> accepted(const twin::Report& r) {
    std::vector<std::string> texts;
    for (const twin::Finding& f : r.findings) {
        if (f.accepted) texts.push_back(f.text);
    }
    return texts;
}

std::string verdict(const twin::Report& r) {
    if (r.passed) {
        return fmt::format(
            "<p><span class=\"pill good\">{}</span> {}; every pixel of the cured block matches its image.</p>\n",
            r.findings.empty() ? "as drawn" : "accepted", counted(r.layers, "layer"));
    }
    return fmt::format(
        "<p><span class=\"pill bad\">not as drawn</span></p>\n<p class=\"message\">First deviation: {}</p>\n",
        html_escaped(r.first_deviation));
}

std::string block_tiles(const twin::Report& r) {
    std::string out = "<section class=\"tiles\">\n";
    out += html_tile(fmt::format("{}", r.layers),
                     r.missing_layers > 0 ? fmt::format("layers cured, {} missing", r.missing_layers) : "layers cured");
    out += html_tile(fmt::format("{}", r.wrong_pixels), "pixels of all layers with too much or too little of a resin");
    double foreign_mm3 = 0;
    for (const twin::MaterialReport& m : r.materials) foreign_mm3 += m.foreign_mm3;
    out += html_tile(fmt::format("{:.4g} mm³", foreign_mm3), "cured in another resin");
    out += html_tile(fmt::format("{:.3g} %", 100 * r.worst_foreign), "foreign resin in the worst vat that printed");
    out +=
        html_tile(fmt::format("{:.3g} %", 100 * r.worst_residue), "of the film on the part left by the worst cleaning");
    out += html_tile(fmt::format("{:.0f} µm", r.deepest_overcure_um), "deepest overcure below an overhang");
    return out + "</section>\n";
}

std::string materials_of_block(const twin::Report& r, const job::Manifest& job) {
    const std::vector<Colour> colours = material_colours(job);
    std::string out =
        "<div class=\"scroll\"><table><thead><tr><th>material</th><th>drawn</th><th>requested by the "
        "images</th><th>cured"
        "</th><th>in another resin</th><th>missing</th><th>tolerance</th><th></th></tr></thead><tbody>\n";
    std::size_t index = 0;
    for (const twin::MaterialReport& m : r.materials) {
        out += fmt::format(
            "<tr><td><span class=\"swatch\" style=\"background:{}\"></span>{}</td><td>{}</td><td>{:.3f} "
            "mm³</td><td>{:.3f} "
            "mm³</td><td>{:.3f} mm³</td><td>{:.3f} mm³</td><td>{:.3f} mm³</td><td>{}</td></tr>\n",
            hex(colours[index++]), html_escaped(m.name),
            m.model_mm3 > 0 ? fmt::format("{:.3f} mm³", m.model_mm3) : std::string("–"), m.wanted_mm3, m.cured_mm3,
            m.foreign_mm3, m.missing_mm3, m.tolerance_mm3, m.passed ? "as drawn" : "<b>off</b>");
    }
    return out + "</tbody></table></div>\n";
}

/// Resins of the vats that have cured anything.
std::string resins(const twin::Report& r) {
    std::string out =
        "<div class=\"scroll\"><table><thead><tr><th>resin</th><th>cured</th><th>left in the vat</th><th>foreign share"
        "</th><th>overcured below overhangs</th></tr></thead><tbody>\n";
    for (const twin::ResinReport& resin : r.resins) {
        if (resin.cured_mm3 <= 0) continue;
        out += fmt::format(
            "<tr><td>{}</td><td>{:.3f} mm³</td><td>{:.1f} ml</td><td>{:.3g} %</td><td>{:.3f} mm³</td></tr>\n",
            html_escaped(resin.name), resin.cured_mm3, resin.left_ml, 100 * resin.foreign_share, resin.overcure_mm3);
    }
    return out + "</tbody></table></div>\n";
}

std::string list(std::string_view title, const std::vector<std::string>& lines) {
    if (lines.empty()) return "";
    std::string out = fmt::format("<h3>{}</h3>\n<ul>\n", title);
    for (std::size_t k = 0; k < std::min(lines.size(), most_lines); ++k)
        out += "<li>" + html_escaped(lines[k]) + "</li>\n";
    if (lines.size() > most_lines) out += fmt::format("<li>and {} more</li>\n", lines.size() - most_lines);
    return out + "</ul>\n";
}

std::string trapped(const twin::Report& r) {
    if (r.trapped.empty()) return "";
    double ml = 0;
    for (const twin::Trapped& t : r.trapped) ml += t.ml;
    const twin::Trapped& most = r.trapped.front();
    return fmt::format(
        "<p class=\"message\">{:.3f} ml of liquid resin stay in the part, "
        "in {} {}; most of it in a {} between {:.2f} and {:.2f} mm.</p>\n",
        ml, r.trapped.size(), r.trapped.size() == 1 ? "place" : "places", most.closed ? "closed pocket" : "cup",
        most.z_begin_um / 1000.0, most.z_end_um / 1000.0);
}

}  // namespace

std::string block_section(const CuredBlock& block, const job::Manifest& job, const std::string& png) {
    const twin::Report& r = block.report;
    return "<h2>What has cured</h2>\n" + verdict(r) +
           fmt::format(
               "<figure><img alt=\"Drawing and cured block\" src=\"data:image/png;base64,{}\"><figcaption>The "
               "drawing and the block of the virtual printer, platform below{}</figcaption></figure>\n",
               base64(png), block.off.runs().empty() ? "" : "; where they differ in colour, however little it is") +
           block_tiles(r) + materials_of_block(r, job) + resins(r) + trapped(r) + list("What is wrong", r.reasons) +
           list("What was accepted", accepted(r)) + list("What broke on the way", r.log.mishaps);
}

}  // namespace pliant::report
