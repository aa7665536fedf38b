// Text files for report.html, compiled into the program.
#pragma once

#include <string_view>

namespace pliant::report::assets {

extern const std::string_view report_css;
extern const std::string_view report_js;
extern const std::string_view dygraphs_js;  ///< dygraphs, MIT licence
extern const std::string_view dygraphs_css;
extern const std::string_view dygraphs_licence;  ///< its copyright notice, which must accompany every copy

}  // namespace pliant::report::assets
