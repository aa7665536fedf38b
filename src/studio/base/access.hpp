// Access control of the studio. Loopback needs no password, but a browser may also send requests of other sites' pages:
// these carry another Host (a name that was made to resolve to this machine) or another Origin.
#pragma once

#include <string>
#include <string_view>

namespace pliant::studio {

struct AccessRules {
    int port = 0;
    std::string token;             ///< empty: bound to loopback only, no token needed
    bool token_from_file = false;  ///< not part of the address that was printed
};

/// The parts of a request that decide about access.
struct Credentials {
    std::string_view host;    ///< header Host
    std::string_view origin;  ///< header Origin; empty if missing
    std::string_view cookie;  ///< header Cookie
    std::string_view bearer;  ///< of the header Authorization
    std::string_view query_token;
    bool websocket = false;
};

enum class Access { granted, wrong_host, wrong_origin, no_token, wrong_token };

/// Without a token only loopback names with the right port are accepted as Host. An Origin must be this very page; a
/// WebSocket must have one. With a token any Host is accepted, and the token must be in the query, a cookie or a bearer
/// header.
[[nodiscard]] Access check_access(const AccessRules& rules, const Credentials& credentials);

/// One line for the person who was refused: what was wrong, and what would be right.
[[nodiscard]] const char* refusal_text(const AccessRules& rules, Access access);

/// 32 letters and digits from the system's source of randomness.
[[nodiscard]] std::string random_key();

/// Of the cookie with the token. Cookies of a host are shared by all its ports, so that its studios would take each
/// other's: each has a name of its own.
[[nodiscard]] std::string cookie_name(const AccessRules& rules);

/// "http://camera:8080" for "http://camera:8080/stream?fps=5"; "" if it is not a plain http or https address: letters,
/// digits, dots, hyphens, a port.
[[nodiscard]] std::string origin_of(std::string_view address);

}  // namespace pliant::studio
