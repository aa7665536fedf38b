// Requests and responses as the routes see them, whatever carries them.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "base/core/error.hpp"

namespace pliant::studio {

struct Request {
    std::string method;  ///< "GET", "POST", "PUT"
    std::string path;    ///< decoded, without the query
    std::map<std::string, std::string> query{};
    std::map<std::string, std::string> parts{};  ///< of the path, as the route names them
    std::string page{};                          ///< header X-Pliant-Page: who asks
    std::string body{};
    /// Of a route that streams: the next bytes of the body, 0 at its end, negative where the line broke.
    std::function<long long(char* into, std::size_t most)> more{};
    long long length = -1;  ///< of that body; negative where it is not known
};

struct Response {
    int status = 200;
    std::string type = "application/json";
    std::string body{};
    std::string file_name{};    ///< not empty: the browser saves it under this name
    bool packed = false;        ///< body is gzip
    bool keep = false;          ///< may be kept for good: its address changes with its content
    std::string images_from{};  ///< origin that the page may also show images from
    std::string location{};     ///< not empty: where the browser goes instead
};

[[nodiscard]] Response json_response(std::string json);
/// {"error": "..."} with 422 for bad input, 409 for failed work.
[[nodiscard]] Response error_response(const Error& error);
[[nodiscard]] Response error_response(int status, std::string_view text);

/// Uploads beyond this are refused before they are read.
inline constexpr long long largest_body = 4 << 20;

}  // namespace pliant::studio
