// Who may talk to the studio. Loopback needs no password, but a browser brings pages of others along: their requests
// carry another Host (a name that was made to point here) or another Origin.
#pragma once

#include <string>
#include <string_view>

namespace pliant::studio {

struct AccessRules {
    int port = 0;
    std::string token;  ///< empty: bound to loopback only, where none is needed
};

/// What of a request decides.
struct Credentials {
    std::string_view host;    ///< header Host
    std::string_view origin;  ///< header Origin; empty where there is none
    std::string_view cookie;  ///< header Cookie
    std::string_view bearer;  ///< of the header Authorization
    std::string_view query_token;
    bool websocket = false;
};

enum class Access { granted, wrong_host, wrong_origin, no_token };

/// Without a token only loopback names with the right port are hosts. An origin must be this very page; a WebSocket
/// needs one. With a token any host will do, and the token must come in the query, a cookie or as a bearer.
[[nodiscard]] Access check_access(const AccessRules& rules, const Credentials& credentials);

/// 32 letters and digits from the system's source of randomness.
[[nodiscard]] std::string random_key();

inline constexpr std::string_view cookie_name = "pliant_token";

/// "http://camera:8080" of "http://camera:8080/stream?fps=5"; "" of what is no plain address by http or https: letters,
/// digits, dots, hyphens, a port.
[[nodiscard]] std::string origin_of(std::string_view address);

}  // namespace pliant::studio
