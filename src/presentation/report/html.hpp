// report.html: one page with everything on it, that needs no network.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "presentation/report/pictures.hpp"
#include "presentation/report/simulation.hpp"

namespace pliant::report {

/// Key figures, pictures, tables, and plots of tension, pressure, markers, support forces and solver. Whatever the
/// robot file called things is shown as text, never run.
[[nodiscard]] std::string report_html(const Simulation& simulation, const std::vector<Picture>& pictures);

/// Text for HTML bodies and quoted attributes: & < > " ' are escaped; what is not UTF-8 is replaced.
[[nodiscard]] std::string html_escaped(std::string_view text);

/// The same with its line breaks, for <pre>.
[[nodiscard]] std::string escaped_lines(std::string_view text);

/// A figure and what it is, as report.css shows them in a row.
[[nodiscard]] std::string html_tile(std::string_view value, std::string_view what);

/// JSON that may stand inside a script element: no <, > or & is left in it, and no line separator of JavaScript.
[[nodiscard]] std::string script_safe_json(std::string_view json);

}  // namespace pliant::report
