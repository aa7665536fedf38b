// Requests and responses as the routes see them, independent of the server.
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
    std::map<std::string, std::string> parts{};  ///< parameters in the path, by their names in the route
    std::string page{};                          ///< header X-Pliant-Page: the requesting page
    std::string body{};
    /// For a streaming route: reads the next bytes of the body; 0 at its end, negative if the connection broke.
    std::function<long long(char* into, std::size_t most)> more{};
    long long length = -1;  ///< of that body; negative if unknown
};

struct Response {
    int status = 200;
    std::string type = "application/json";
    std::string body{};
    std::string file_name{};    ///< not empty: the browser saves it under this name
    bool packed = false;        ///< the body is compressed with gzip
    bool keep = false;          ///< may be cached for ever: its address changes with its content
    std::string images_from{};  ///< further origin that the page may load images from
    std::string location{};     ///< not empty: redirect to this address
};

[[nodiscard]] Response json_response(std::string json);
/// {"error": "..."} with status 422 for bad input, 409 for failed work.
[[nodiscard]] Response error_response(const Error& error);
[[nodiscard]] Response error_response(int status, std::string_view text);
/// {} if it was done, else the error.
[[nodiscard]] Response done(const Status& status);

/// Larger uploads are refused before they are read.
inline constexpr long long largest_body = 4 << 20;

}  // namespace pliant::studio
