#include "presentation/report/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/core/base64.hpp"
#include "base/core/counted.hpp"
#include "presentation/draw/canvas.hpp"
#include "presentation/report/assets.hpp"
#include "presentation/report/convergence.hpp"
#include "presentation/report/summary.hpp"

namespace pliant::report {
namespace {

/// "12,345"
std::string grouped(std::size_t value) {
    const std::string digits = std::to_string(value);
    std::string out;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) out += ',';
        out += digits[i];
    }
    return out;
}

std::string seconds(double s) {
    if (s < 0.9995) return fmt::format("{:.3g} ms", 1e3 * s);
    return s < 120 ? fmt::format("{:.3g} s", s) : fmt::format("{:.1f} min", s / 60);
}

/// A table from a header and rows of plain text; `kind` is a class of report.css.
std::string table(std::string_view kind, const std::vector<std::string>& header,
                  const std::vector<std::vector<std::string>>& rows) {
    std::string out = fmt::format("<div class=\"scroll\"><table class=\"{}\"><thead><tr>", kind);
    for (const auto& name : header) out += "<th>" + html_escaped(name) + "</th>";
    out += "</tr></thead><tbody>\n";
    for (const auto& row : rows) {
        out += "<tr>";
        for (const auto& cell : row) out += "<td>" + html_escaped(cell) + "</td>";
        out += "</tr>\n";
    }
    return out + "</tbody></table></div>\n";
}

/// The status lamp beside the name: not green if there are warnings.
struct Verdict {
    std::string_view kind, text;  ///< a class of report.css, and what it says
};
Verdict verdict_of(const sim::Trajectory& result) {
    if (!result.converged) return {"bad", "stopped early"};
    const auto loose = [](const sim::Step& step) { return !step.converged; };
    if (std::any_of(result.steps.begin(), result.steps.end(), loose)) return {"warn", "accepted above the tolerance"};
    if (!result.warnings.empty()) return {"warn", "converged, with a warning"};
    return {"good", "converged"};
}

std::string heading(const Simulation& s) {
    const auto& result = s.result;
    const Verdict verdict = verdict_of(result);
    std::string out = fmt::format(
        "<div class=\"head\"><h1>{}</h1><span class=\"pill {}\">{}</span></div>\n"
        "<p class=\"faint\">{} by {}, {} nodes, {} {} tets, solved in {}</p>\n",
        html_escaped(s.robot), verdict.kind, verdict.text, counted(result.steps.size() - 1, "step"),
        html_escaped(result.solver.empty() ? "the solver" : result.solver), grouped(s.mesh.points.size()),
        grouped(s.mesh.tet_count()), s.mesh.order == 2 ? "quadratic" : "linear", seconds(result.solve_s));
    if (!result.message.empty()) out += "<p class=\"message\">" + html_escaped(result.message) + "</p>\n";
    for (const std::string& warning : result.warnings)
        out += "<p class=\"message\">" + html_escaped(warning) + "</p>\n";
    return out;
}

std::string tiles(const Simulation& s) {
    constexpr std::size_t shown = 3;
    const sim::Step& rest = s.result.steps.front();
    const sim::Step& last = s.result.steps.back();
    std::string out = "<section class=\"tiles\">\n";
    for (std::size_t i = 0; i < std::min(shown, last.cables.size()); ++i) {
        const auto& c = last.cables[i];
        const std::string length = fmt::format("{:.1f} %", 100 * c.length_ratio);
        out += html_tile(fmt::format("{:.4g} N", c.tension_N), fmt::format("{} at {} length", c.name, length));
    }
    for (std::size_t i = 0; i < std::min(shown, last.chambers.size()); ++i) {
        const auto& c = last.chambers[i];
        const std::string volume = fmt::format("{:.1f} %", 100 * c.volume_ratio);
        out +=
            html_tile(fmt::format("{:.4g} kPa", 1e-3 * c.pressure_Pa), fmt::format("{} at {} volume", c.name, volume));
    }
    for (std::size_t i = 0; i < std::min(shown, last.contacts.size()); ++i) {
        const auto& c = last.contacts[i];
        out += html_tile(fmt::format("{:.4g} N", norm(c.force_N)), fmt::format("force of {}", c.name));
    }
    for (std::size_t i = 0; i < std::min(shown, last.markers.size()); ++i) {
        const double way = norm(last.markers[i].position_m - rest.markers[i].position_m);
        out += html_tile(fmt::format("{:.4g} mm", 1e3 * way), fmt::format("{} moved", last.markers[i].name));
    }
    double least = 1;
    int iterations = 0;
    for (const auto& step : s.result.steps) {
        least = std::min(least, step.min_J);
        iterations += step.iterations;
    }
    out += html_tile(fmt::format("{:.3f}", least), "smallest det F");
    const auto steps = static_cast<double>(s.result.steps.size()) - 1;
    if (s.result.solve_s > 0) out += html_tile(fmt::format("{:.3g} /s", steps / s.result.solve_s), "steps solved");
    out += html_tile(grouped(static_cast<std::size_t>(std::max(0, iterations))), "iterations total");
    out += html_tile(fmt::format("{:.0f} MB", s.peak_memory_MB), "peak memory");
    return out + "</section>\n";
}

std::string pictures_section(const std::vector<Picture>& pictures) {
    if (pictures.empty()) return "";
    std::vector<const Picture*> order;
    order.reserve(pictures.size());
    for (const auto& p : pictures) order.push_back(&p);
    std::stable_partition(order.begin(), order.end(), [](const Picture* p) { return p->file == "final.png"; });
    std::string out = "<section class=\"pictures\">\n";
    for (const Picture* p : order) {
        out += fmt::format(
            "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
            html_escaped(p->title), base64(p->png));
    }
    return out + "</section>\n";
}

/// Volume in m^3 of each material in the mesh at rest.
std::vector<double> material_volumes(const Simulation& s) {
    std::vector<double> volumes(s.materials.size());
    for (std::size_t r = 0; r < s.region_material.size(); ++r) {
        const int material = s.region_material[r];
        if (material >= 0) volumes[static_cast<std::size_t>(material)] += mesh::volume(s.mesh, static_cast<int>(r));
    }
    return volumes;
}

std::string materials_section(const Simulation& s) {
    const auto volumes = material_volumes(s);
    std::string out =
        "<h2>Materials</h2>\n<div class=\"scroll\"><table class=\"words\"><thead><tr><th>material</th><th>law</th>"
        "<th>resin</th><th>volume</th><th>mass</th></tr></thead><tbody>\n";
    for (std::size_t m = 0; m < s.materials.size(); ++m) {
        const Material& material = s.materials[m];
        const std::string mass =
            material.density_kg_m3 > 0 ? fmt::format("{:.4g} g", 1e3 * material.density_kg_m3 * volumes[m]) : "–";
        out += fmt::format(
            "<tr><td><span class=\"swatch\" style=\"background:{}\"></span>{}</td><td>{}</td><td>{}</td>"
            "<td>{:.4g} cm³</td><td>{}</td></tr>\n",
            hex(colour_of(s, static_cast<int>(m))), html_escaped(material.name), html_escaped(material.law),
            html_escaped(material.resin.empty() ? "–" : material.resin), 1e6 * volumes[m], mass);
    }
    return out + "</tbody></table></div>\n";
}

std::string actuators_section(const Simulation& s) {
    const sim::Step& rest = s.result.steps.front();
    const sim::Step& last = s.result.steps.back();
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < last.cables.size(); ++i) {
        const auto& c = last.cables[i];
        rows.push_back({c.name, "cable", fmt::format("{:.2f} mm", 1e3 * rest.cables[i].length_m),
                        fmt::format("{:.2f} mm", 1e3 * c.length_m), fmt::format("{:.4f}", c.length_ratio),
                        fmt::format("{:.4g} N", c.tension_N)});
    }
    for (std::size_t i = 0; i < last.chambers.size(); ++i) {
        const auto& c = last.chambers[i];
        rows.push_back({c.name, "chamber", fmt::format("{:.1f} mm³", 1e9 * rest.chambers[i].volume_m3),
                        fmt::format("{:.1f} mm³", 1e9 * c.volume_m3), fmt::format("{:.4f}", c.volume_ratio),
                        fmt::format("{:.4g} kPa", 1e-3 * c.pressure_Pa)});
    }
    if (rows.empty()) return "";
    return "<h2>Actuators</h2>\n" +
           table("", {"actuator", "kind", "at rest", "at the end", "ratio", "tension or pressure"}, rows);
}

/// "(0.1, 0, -2.5)"
std::string vector_text(const Vec3& v) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x, v.y, v.z);
}

std::string contact_section(const Simulation& s) {
    if (!has_contact(s.result)) return "";
    const sim::Step& last = s.result.steps.back();
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < last.contacts.size(); ++i) {
        double largest = 0;
        for (const sim::Step& step : s.result.steps) largest = std::max(largest, norm(step.contacts[i].force_N));
        const Vec3& force = last.contacts[i].force_N;
        rows.push_back({last.contacts[i].name, vector_text(force), fmt::format("{:.4g}", norm(force)),
                        fmt::format("{:.4g}", largest)});
    }
    double most = 0, nearest = HUGE_VAL;
    for (const sim::Step& step : s.result.steps) {
        most = std::max(most, step.self_contact_N);
        nearest = std::min(nearest, step.smallest_distance_m);
    }
    rows.push_back({"the robot itself", "–", fmt::format("{:.4g}", last.self_contact_N), fmt::format("{:.4g}", most)});
    std::string out =
        "<h2>Contact</h2>\n" +
        table("", {"with", "force on the robot at the end, N", "its size, N", "largest of all steps, N"}, rows);
    if (std::isfinite(nearest))
        out += fmt::format("<p class=\"faint\">Surfaces came as near as {:.3g} mm.</p>\n", 1e3 * nearest);
    return out;
}

std::string measured_section(const Simulation& s) {
    if (s.measured.empty()) return "";
    std::vector<std::vector<std::string>> rows;
    for (const Deviation& d : deviations(s.measured, s.result)) {
        rows.push_back({d.marker, fmt::format("{}", d.points), fmt::format("{:.3g} mm", 1e3 * d.mean_m),
                        fmt::format("{:.3g} mm", 1e3 * d.largest_m), fmt::format("{:.3g} mm", 1e3 * d.way_m)});
    }
    return "<h2>Markers as " + html_escaped(s.measured_as) + "</h2>\n" +
           table("", {"marker", "points", "mean distance", "largest", "simulated way"}, rows);
}

std::string steps_section(const Simulation& s) {
    std::vector<std::string> header = {"step", "time", "solver", "iterations", "residual", "wall time", "min J"};
    for (const auto& c : s.result.steps.front().cables) header.push_back(c.name + ", N");
    for (const auto& c : s.result.steps.front().chambers) header.push_back(c.name + ", kPa");
    for (const auto& o : s.result.steps.front().contacts) header.push_back(o.name + ", N");
    std::vector<std::vector<std::string>> rows;
    for (const auto& step : s.result.steps) {
        rows.push_back({fmt::format("{}", step.index), fmt::format("{:.4g}", step.time),
                        step.index == 0 ? "–" : std::string(sim::name(step.solver)), fmt::format("{}", step.iterations),
                        fmt::format("{:.2e}", step.residual), seconds(step.wall_s), fmt::format("{:.4f}", step.min_J)});
        for (const auto& c : step.cables) rows.back().push_back(fmt::format("{:.4g}", c.tension_N));
        for (const auto& c : step.chambers) rows.back().push_back(fmt::format("{:.4g}", 1e-3 * c.pressure_Pa));
        for (const auto& o : step.contacts) rows.back().push_back(vector_text(o.force_N));
    }
    return "<h2>Steps</h2>\n<details><summary>Every step in numbers</summary>\n" + table("", header, rows) +
           "</details>\n";
}

std::string settings_section(const Simulation& s) {
    std::vector<std::vector<std::string>> rows = {{"tolerance", fmt::format("{:g}", s.tolerance)},
                                                  {"mesh", seconds(s.timing.mesh_s)},
                                                  {"setup", seconds(s.timing.model_s + s.result.setup_s)},
                                                  {"solve", seconds(s.result.solve_s)},
                                                  {"files", seconds(s.timing.files_s)},
                                                  {"pictures", seconds(s.timing.pictures_s)}};
    for (const auto& [name, value] : s.settings) rows.push_back({name, value});
    return "<h2>Settings</h2>\n" + table("words", {"setting", "value"}, rows);
}

}  // namespace

std::string html_escaped(std::string_view text) {
    std::string out;
    for (const char c : printable(text)) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string escaped_lines(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        out += html_escaped(text.substr(0, end)) + "\n";
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return out;
}

std::string html_tile(std::string_view value, std::string_view what) {
    return fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>\n", html_escaped(value), html_escaped(what));
}

std::string script_safe_json(std::string_view json) {
    std::string out;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const std::string_view three = json.substr(i, 3);
        if (json[i] == '<' || json[i] == '>' || json[i] == '&') {
            out += fmt::format("\\u{:04x}", static_cast<unsigned>(json[i]));
        } else if (three == "\xe2\x80\xa8" || three == "\xe2\x80\xa9") {
            out += three[2] == '\xa8' ? "\\u2028" : "\\u2029";
            i += 2;
        } else {
            out += json[i];
        }
    }
    return out;
}

std::string report_html(const Simulation& s, const std::vector<Picture>& pictures) {
    std::string out =
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
        "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n";
    out += "<title>" + html_escaped(s.robot) + " · Pliant</title>\n";
    out +=
        fmt::format("<style>\n{}\n{}\n</style>\n</head>\n<body>\n<main>\n", assets::dygraphs_css, assets::report_css);
    out += heading(s) + tiles(s) + pictures_section(pictures);
    out +=
        "<h2>Plots</h2>\n<section class=\"plots\" id=\"plots\"><noscript>The plots need JavaScript; the numbers are "
        "in the tables below.</noscript></section>\n";
    out += actuators_section(s) + measured_section(s) + contact_section(s) + materials_section(s) + steps_section(s) +
           settings_section(s);
    out += "<footer><p>Made by Pliant " PLIANT_VERSION
           ". Nothing on this page is loaded from a network.</p>\n"
           "<details><summary>Licence of the plotting library</summary><pre>" +
           escaped_lines(assets::dygraphs_licence) + "</pre></details></footer>\n</main>\n";
    out += "<script type=\"application/json\" id=\"data\">" + script_safe_json(summary_json(s, -1)) + "</script>\n";
    if (!s.result.iterations.empty())
        out += "<script type=\"application/json\" id=\"iterations\">" + script_safe_json(iterations_json(s.result)) +
               "</script>\n";
    out += fmt::format("<script>{}</script>\n<script>{}</script>\n</body>\n</html>\n", assets::dygraphs_js,
                       assets::report_js);
    return out;
}

}  // namespace pliant::report
