#include "studio/base/access.hpp"

#include <fmt/format.h>

#include <random>

namespace pliant::studio {
namespace {

/// Constant-time comparison for texts of equal length.
bool equal(std::string_view a, std::string_view b) {
    if (a.size() != b.size()) return false;
    unsigned difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
    return difference == 0;
}

std::string_view cookie_value(std::string_view cookies, std::string_view name) {
    while (!cookies.empty()) {
        const std::size_t end = std::min(cookies.find(';'), cookies.size());
        std::string_view one = cookies.substr(0, end);
        cookies.remove_prefix(std::min(end + 1, cookies.size()));
        while (one.starts_with(' ')) one.remove_prefix(1);
        if (one.size() > name.size() && one.starts_with(name) && one[name.size()] == '=')
            return one.substr(name.size() + 1);
    }
    return {};
}

bool is_loopback_host(std::string_view host, int port) {
    for (const char* name : {"localhost", "127.0.0.1", "[::1]"}) {
        if (host == fmt::format("{}:{}", name, port)) return true;
        if (port == 80 && host == name) return true;
    }
    return false;
}

}  // namespace

Access check_access(const AccessRules& rules, const Credentials& c) {
    if (rules.token.empty() && !is_loopback_host(c.host, rules.port)) return Access::wrong_host;
    if (c.host.empty()) return Access::wrong_host;
    if (c.origin.empty() ? c.websocket : c.origin != fmt::format("http://{}", c.host)) return Access::wrong_origin;
    if (rules.token.empty()) return Access::granted;
    bool some = false;
    for (const std::string_view offered : {c.query_token, c.bearer, cookie_value(c.cookie, cookie_name(rules))}) {
        if (equal(offered, rules.token)) return Access::granted;
        some = some || !offered.empty();
    }
    return some ? Access::wrong_token : Access::no_token;
}

const char* refusal_text(const AccessRules& rules, Access access) {
    switch (access) {
        case Access::granted:
            break;
        case Access::wrong_host:
            return "this name is not the studio's; use the address that it printed";
        case Access::wrong_origin:
            return "requests from other pages are refused";
        case Access::no_token:
            return rules.token_from_file ? "the token is missing: add ?token=TOKEN to the address; the token is in the "
                                           "file that the studio was given with --token-file"
                                         : "the token is missing: use the address that the studio printed";
        case Access::wrong_token:
            return rules.token_from_file
                       ? "the token is wrong: it is in the file that the studio was given with --token-file"
                       : "the token is wrong: use the address that the studio printed when it was started";
    }
    return "";
}

std::string cookie_name(const AccessRules& rules) {
    return fmt::format("pliant_token_{}", rules.port);
}

std::string random_key() {
    static constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";
    std::random_device source;
    std::uniform_int_distribution<std::size_t> pick(0, letters.size() - 1);
    std::string key;
    for (int i = 0; i < 32; ++i) key += letters[pick(source)];
    return key;
}

std::string origin_of(std::string_view address) {
    const std::size_t scheme = address.starts_with("https://") ? 8 : address.starts_with("http://") ? 7 : 0;
    if (scheme == 0) return "";
    const std::string_view host = address.substr(scheme, address.find_first_of("/?#", scheme) - scheme);
    constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-:[]";
    if (host.empty() || host.find_first_not_of(allowed) != std::string_view::npos) return "";
    return std::string(address.substr(0, scheme + host.size()));
}

}  // namespace pliant::studio
