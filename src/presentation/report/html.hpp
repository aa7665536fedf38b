// report.html: one self-contained page that needs no network.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "presentation/report/pictures.hpp"
#include "presentation/report/simulation.hpp"

namespace pliant::report {

/// Key figures, pictures, tables, and plots of tension, pressure, markers, support forces and solver. Names from the
/// robot file are shown as text, never executed.
[[nodiscard]] std::string report_html(const Simulation& simulation, const std::vector<Picture>& pictures);

/// Text for HTML bodies and quoted attributes: & < > " ' are escaped; invalid UTF-8 is replaced.
[[nodiscard]] std::string html_escaped(std::string_view text);

/// The same with its line breaks, for <pre>.
[[nodiscard]] std::string escaped_lines(std::string_view text);

/// A figure with its label, displayed by report.css in a row.
[[nodiscard]] std::string html_tile(std::string_view value, std::string_view what);

/// JSON that is safe inside a script element: without <, > or &, and without JavaScript line separators.
[[nodiscard]] std::string script_safe_json(std::string_view json);

}  // namespace pliant::report
